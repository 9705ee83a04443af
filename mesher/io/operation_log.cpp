// Writing and reading of linearization logs. podm/operation_log.h describes the format.
#include "podm/operation_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "podm/errors.h"

namespace podm {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

constexpr std::string_view kMagic = "podmlog1";
constexpr std::string_view kSchema = "podm-log/2";
// Limit of operations and of removals; far above what the writer makes.
constexpr std::uint32_t kMaxBatch = 1u << 24;

struct BatchSizes {
  std::uint32_t operations = 0, removed = 0;
};

// Reads a log from front to back. Every error names the byte.
class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
    if (!stream_) throw InputError(path + ": cannot be opened");
  }

  OperationLog read() {
    std::string magic(kMagic.size(), '\0');
    take(magic.data(), magic.size(), "the first 8 bytes");
    if (magic != kMagic) fail("not a linearization log of podm");
    OperationLog log;
    while (take_batch(log.all)) {
    }
    log.head = take_head();
    sort(log.all);
    return log;
  }

 private:
  [[noreturn]] void fail(const std::string& fault) const {
    throw InputError(fmt::format("{}: at byte {}: {}", path_, offset_, fault));
  }

  void take(void* into, std::size_t size, const char* what) {
    if (!stream_.read(static_cast<char*>(into), static_cast<std::streamsize>(size)))
      fail(fmt::format("the file ends within {}", what));
    offset_ += size;
  }

  // Reads in steps, so that a wrong count cannot request more memory than the file has bytes.
  template <class T>
  void take_all(std::vector<T>& into, std::uint32_t count, const char* what) {
    constexpr std::uint32_t kStep = 1 << 12;
    for (std::uint32_t left = count; left > 0;) {
      const std::uint32_t step = std::min(left, kStep);
      into.resize(into.size() + step);
      take(&into[into.size() - step], step * sizeof(T), what);
      left -= step;
    }
  }

  bool take_batch(OperationBatch& all) {
    BatchSizes sizes;
    take(&sizes, sizeof sizes, "the counts of a batch");
    if (sizes.operations == 0 && sizes.removed == 0) return false;
    if (sizes.operations > kMaxBatch || sizes.removed > kMaxBatch) fail("a batch of impossible size");
    const std::size_t first = all.operations.size();
    take_all(all.operations, sizes.operations, "operations");
    take_all(all.removed, sizes.removed, "removed vertices");
    std::uint64_t num_removed = 0;
    for (std::size_t i = first; i < all.operations.size(); ++i) {
      const LoggedOperation& operation = all.operations[i];
      num_removed += operation.num_removed;
      for (const double x : operation.point)
        if (!std::isfinite(x))
          fail(fmt::format("{}: not a finite point", operation_text(operation.sequence)));
    }
    if (num_removed != sizes.removed)
      fail("the number of vertices that a batch removes differs from the sum over its operations");
    return true;
  }

  OperationLogHead take_head() {
    const std::string text(std::istreambuf_iterator<char>(stream_), {});
    try {
      const auto json = nlohmann::ordered_json::parse(text);
      if (json.at("schema") != kSchema) fail(fmt::format("schema is not {}", kSchema));
      OperationLogHead head;
      json.at("box").get_to(head.box);
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(head.box[axis] < head.box[axis + 3])) fail("the box is empty");
      json.at("image_sha256").get_to(head.image_sha256);
      json.at("space").get_to(head.space);
      json.at("mesh_sha256").get_to(head.mesh_sha256);
      if (json.contains("ranks")) take_ranks(json["ranks"], head);
      if (json.contains("smoothing_mm")) take_smoothing(json["smoothing_mm"], head);
      head.is_box_flat = json.value("is_box_flat", false);
      return head;
    } catch (const nlohmann::ordered_json::exception& error) {
      fail(fmt::format("the description of the run: {}", error.what()));
    }
  }

  void take_ranks(const nlohmann::ordered_json& json, OperationLogHead& head) const {
    json.at("number").get_to(head.num_ranks);
    json.at("rank").get_to(head.rank);
    json.at("mesh_hash").get_to(head.mesh_hash);
    if (head.rank < 0 || head.rank >= head.num_ranks)
      fail(fmt::format("rank {} of {} ranks does not exist", head.rank, head.num_ranks));
    if (json.contains("cubes")) head.cubes = take_cubes(json["cubes"]);
  }

  CubesOfRank take_cubes(const nlohmann::ordered_json& json) const {
    CubesOfRank cubes;
    json.at("grid").get_to(cubes.grid);
    json.at("side_mm").get_to(cubes.side_mm);
    json.at("block").get_to(cubes.block);
    json.at("known").get_to(cubes.known);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!(cubes.grid[axis] < cubes.grid[axis + 3])) fail("the grid of cubes is empty");
    if (!(cubes.side_mm > 0)) fail(fmt::format("cubes with sides of {} mm", cubes.side_mm));
    for (const auto* runs : {&cubes.block, &cubes.known})
      for (std::size_t i = 0; i < runs->size(); ++i)
        if ((*runs)[i][0] > (*runs)[i][1] || (i > 0 && (*runs)[i][0] <= (*runs)[i - 1][1]))
          fail(fmt::format("cubes {} to {} are not in order", (*runs)[i][0], (*runs)[i][1]));
    return cubes;
  }

  void take_smoothing(const nlohmann::ordered_json& json, OperationLogHead& head) const {
    json.get_to(head.smoothing_mm);
    if (!(head.smoothing_mm > 0)) fail(fmt::format("smoothed by {} mm", head.smoothing_mm));
  }

  void sort(OperationBatch& all) const {
    std::vector<std::size_t> first_removed(all.operations.size());
    std::vector<std::size_t> order(all.operations.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = i;
      first_removed[i] = next;
      next += all.operations[i].num_removed;
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return all.operations[a].sequence < all.operations[b].sequence;
    });
    OperationBatch sorted;
    sorted.operations.reserve(order.size());
    sorted.removed.reserve(all.removed.size());
    for (const std::size_t i : order) {
      const LoggedOperation& operation = all.operations[i];
      if (!sorted.operations.empty() && sorted.operations.back().sequence == operation.sequence)
        fail(fmt::format("two are {}", operation_text(operation.sequence)));
      sorted.operations.push_back(operation);
      const auto from = all.removed.begin() + static_cast<std::ptrdiff_t>(first_removed[i]);
      sorted.removed.insert(sorted.removed.end(), from, from + operation.num_removed);
    }
    all = std::move(sorted);
  }

  std::string path_;
  std::ifstream stream_;
  std::size_t offset_ = 0;
};

}  // namespace

std::string operation_text(std::uint64_t sequence) {
  const std::uint64_t step = step_of(sequence), number = sequence - (step << kBitsInStep);
  return step == 0 ? fmt::format("operation {}", number)
                   : fmt::format("operation {} of step {}", number, step);
}

struct OperationLogWriter::File {
  explicit File(const std::string& log_path) : path(log_path) { open(); }
  void open() {
    file.reset();  // frees the name of the temporary file
    file = std::make_unique<AtomicFile>(path);
    file->write(kMagic);
  }

  std::string path;
  std::mutex mutex;
  std::unique_ptr<AtomicFile> file;
};

OperationLogWriter::OperationLogWriter(const std::string& path) : file_(std::make_unique<File>(path)) {}
OperationLogWriter::~OperationLogWriter() = default;

void OperationLogWriter::begin_step() { least_sequence_ = (step_of(least_sequence_) + 1) << kBitsInStep; }

void OperationLogWriter::restart() {
  file_->open();
  least_sequence_ = 0;
}

void OperationLogWriter::append(const OperationBatch& batch) {
  if (batch.operations.empty()) return;
  const BatchSizes sizes{static_cast<std::uint32_t>(batch.operations.size()),
                         static_cast<std::uint32_t>(batch.removed.size())};
  const std::scoped_lock lock(file_->mutex);
  file_->file->put(sizes);
  file_->file->write(batch.operations.data(), batch.operations.size() * sizeof(LoggedOperation));
  file_->file->write(batch.removed.data(), batch.removed.size() * sizeof(std::uint32_t));
}

void OperationLogWriter::finish(const OperationLogHead& head) {
  nlohmann::ordered_json json{{"schema", kSchema},
                              {"box", head.box},
                              {"image_sha256", head.image_sha256},
                              {"space", head.space},
                              {"mesh_sha256", head.mesh_sha256}};
  if (!head.mesh_hash.empty())
    json["ranks"] = {{"number", head.num_ranks}, {"rank", head.rank}, {"mesh_hash", head.mesh_hash}};
  if (head.cubes)
    json["ranks"]["cubes"] = {{"grid", head.cubes->grid},
                              {"side_mm", head.cubes->side_mm},
                              {"block", head.cubes->block},
                              {"known", head.cubes->known}};
  if (head.is_box_flat) json["is_box_flat"] = true;
  if (head.smoothing_mm > 0) json["smoothing_mm"] = head.smoothing_mm;
  file_->file->put(BatchSizes{});
  file_->file->write(json.dump() + "\n");
  file_->file->finish();
}

void OperationLogWriter::publish() { file_->file->publish(); }

OperationLog read_operation_log(const std::string& path) { return Reader(path).read(); }

}  // namespace podm
