#include "distributed/read_by_bricks.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>

#include "distributed/collective_errors.h"
#include "distributed/image_digest.h"
#include "distributed/messages.h"
#include "image/image_by_bricks.h"
#include "image/interface_sides.h"
#include "image/label_selection.h"
#include "image/rows_of_image.h"
#include "isosurface/surface_masks.h"

namespace podm {

namespace {

// Chunks of a slab have about this many voxels.
constexpr std::size_t kChunk = 1 << 26;

// Layers of bricks.
struct Layers {
  int first, end;
};

Layers layers_of(int rank, int num_ranks, int num_layers) {
  const auto first = [&](int r) { return static_cast<int>(std::int64_t{num_layers} * r / num_ranks); };
  return {first(rank), first(rank + 1)};
}

// Calls use(layers) for parts of a slab that fit in memory.
template <class Use>
void for_each_chunk(const LabelImage& grid, const Layers& slab, const Use& use) {
  const std::size_t of_layer = 4 * unsigned_of(grid.size[0]) * unsigned_of(grid.size[1]);
  const int length = static_cast<int>(std::clamp<std::size_t>(kChunk / of_layer, 1, 1 << 20));
  for (int first = slab.first; first < slab.end; first += length)
    use(Layers{first, std::min(first + length, slab.end)});
}

// The memory that a rank takes to read: a chunk with the layers around it, as bytes and as labels, and the
// labels of bricks of all slabs, before and after they are joined. Those in mixed bricks of a compressed file
// are counted once they are known.
std::uint64_t most_bytes_while_read(const VoxelFile& file) {
  const LabelImage& grid = file.grid();
  const std::size_t of_layer = 4 * unsigned_of(grid.size[0]) * unsigned_of(grid.size[1]);
  const std::size_t voxels = std::min(grid.num_voxels(), std::max(kChunk, of_layer) + 3 * of_layer);
  const std::size_t copies = file.is_compressed() ? 2 : 1;
  return voxels * (copies * bytes_of(file.type()) + sizeof(LabelIndex)) +
         2 * sizeof(LabelIndex) * BrickGrid(grid.size).count();
}

// Slices of a file, which are read from front to back.
class Slices {
 public:
  Slices(const VoxelFile& file, int threads) : file_(file), threads_(num_threads(threads)) {
    if (file.is_compressed()) stream_.emplace(file);
  }
  LabelImage read(int low, int high) {
    const auto [x, y, z] = file_.grid().size;
    high = std::min(high, z);
    return stream_ ? stream_->read(low, high, threads_) : file_.read({0, 0, low}, {x, y, high}, threads_);
  }

 private:
  const VoxelFile& file_;
  const std::size_t threads_;
  std::optional<VoxelStream> stream_;
};

// The labels of the image and the values in the file that have them.
class LabelsOfValues {
 public:
  LabelsOfValues(std::vector<std::uint32_t> values, std::vector<LabelIndex> labels)
      : values_(std::move(values)), labels_(std::move(labels)) {}

  /// Turns the values of a part of the file into the labels of the image.
  void apply(const std::string& path, LabelImage& part, std::size_t threads) const {
    constexpr std::size_t kLength = 1 << 18;
    std::vector<LabelIndex> new_label;
    for (const Label& label : part.labels) {
      const auto found = std::lower_bound(values_.begin(), values_.end(), label.value);
      if (found == values_.end() || *found != label.value)
        throw InputError(path + ": its voxels changed during the run");
      new_label.push_back(labels_[static_cast<std::size_t>(found - values_.begin())]);
    }
    parallel_for_ranges(part.voxels.size(), kLength, threads,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t i = begin; i < end; ++i)
                            part.voxels[i] = new_label[part.voxels[i]];
                        });
  }

 private:
  std::vector<std::uint32_t> values_;
  std::vector<LabelIndex> labels_;  // by position in `values_`
};

// Numbers that add up over the slabs.
struct Census {
  std::vector<std::uint64_t> voxels_of_label;
  std::array<std::uint64_t, 3> sides{};
  std::array<int, 3> low, high{-1, -1, -1};

  void operator+=(const Census& b) {
    for (std::size_t label = 0; label < voxels_of_label.size(); ++label)
      voxels_of_label[label] += b.voxels_of_label[label];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sides[axis] += b.sides[axis];
      low[axis] = std::min(low[axis], b.low[axis]);
      high[axis] = std::max(high[axis], b.high[axis]);
    }
  }
  // Adds a row of a part that begins at slice `first`.
  void add_row(const LabelImage& part, int first, int j, int k) {
    for (std::size_t axis = 0; axis < 3; ++axis) sides[axis] += count_sides(part, axis, 1, j, k);
    const auto row = std::span(part.voxels).subspan(part.index(0, j, k), unsigned_of(part.size[0]));
    for (auto from = row.begin(); from != row.end();) {
      const auto to = std::find_if(from, row.end(), [&](LabelIndex label) { return label != *from; });
      voxels_of_label[*from] += static_cast<std::uint64_t>(to - from);
      if (*from != kBackground)
        add_bounds({static_cast<int>(from - row.begin()), j, first + k},
                   {static_cast<int>(to - row.begin()) - 1, j, first + k});
      from = to;
    }
  }

 private:
  void add_bounds(const std::array<int, 3>& least, const std::array<int, 3>& most) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], least[axis]);
      high[axis] = std::max(high[axis], most[axis]);
    }
  }
};

using LabelsOfBrick = std::array<LabelIndex, 64>;

// The labels of bricks and the numbers of one slab.
struct Slab {
  std::vector<LabelIndex> label_of_brick;
  std::vector<LabelsOfBrick> mixed;  // of mixed bricks, in their order, if the file is compressed
  std::vector<std::string> digests;  // by layer
  Census census;
};

class ReadSlab {
 public:
  ReadSlab(const VoxelFile& file, const LabelsOfValues& labels, std::size_t num_labels, int threads)
      : file_(file),
        labels_(labels),
        threads_(threads),
        slices_(file, threads),
        slab_{
            .label_of_brick = {},
            .mixed = {},
            .digests = {},
            .census = {.voxels_of_label = std::vector<std::uint64_t>(num_labels), .low = file.grid().size}} {}

  Slab operator()(const Layers& slab) {
    for_each_chunk(file_.grid(), slab, [&](const Layers& layers) { add(layers); });
    return std::move(slab_);
  }

 private:
  // A layer more on either side, or a slice, gives the neighbors of the voxels.
  void add(const Layers& layers) {
    const int before = std::max(0, layers.first - 1);
    LabelImage part = slices_.read(4 * before, 4 * layers.end + 1);
    labels_.apply(file_.path(), part, num_threads(threads_));
    const Layers here{layers.first - before, layers.end - before};
    add_bricks(part, here);
    add_census(part, here, 4 * before);
    const std::vector<std::string> more = digests_of_layers(part, here.first, here.end, threads_);
    slab_.digests.insert(slab_.digests.end(), more.begin(), more.end());
  }

  void add_bricks(const LabelImage& part, const Layers& layers) {
    const BrickGrid bricks(part.size);
    SurfaceMasks masks(bricks.count());
    mark_surface(part, bricks, num_threads(threads_), masks);
    const auto [x, y, z] = bricks.size();
    for (int k = layers.first; k < layers.end; ++k)
      for (int j = 0; j < y; ++j)
        for (int i = 0; i < x; ++i) {
          const bool is_mixed = masks[bricks.index(i, j, k)] != 0;
          slab_.label_of_brick.push_back(is_mixed ? ImageByBricks::kMixed
                                                  : part.voxels[part.index(4 * i, 4 * j, 4 * k)]);
          if (is_mixed && file_.is_compressed())
            slab_.mixed.push_back(labels_in(part, {4 * i, 4 * j, 4 * k}));
        }
  }

  static LabelsOfBrick labels_in(const LabelImage& part, const Voxel& first) {
    LabelsOfBrick labels{};
    for (int k = first.k; k < std::min(first.k + 4, part.size[2]); ++k)
      for (int j = first.j; j < std::min(first.j + 4, part.size[1]); ++j)
        for (int i = first.i; i < std::min(first.i + 4, part.size[0]); ++i)
          labels[place_in_brick({i, j, k})] = part.voxels[part.index(i, j, k)];
    return labels;
  }

  void add_census(const LabelImage& part, const Layers& layers, int first_slice) {
    const Census none{.voxels_of_label = std::vector<std::uint64_t>(slab_.census.voxels_of_label.size()),
                      .low = file_.grid().size};
    slab_.census += sum_over_rows(part, threads_, none, [&](Census& sum, int j, int k) {
      if (k >= 4 * layers.first && k < 4 * layers.end) sum.add_row(part, first_slice, j, k);
    });
  }

  const VoxelFile& file_;
  const LabelsOfValues& labels_;
  const int threads_;
  Slices slices_;
  Slab slab_;
};

// The labels of an image whose file is compressed: those of mixed bricks are in memory.
class HeldBricks {
 public:
  // Keeps the reference.
  HeldBricks(const ImageByBricks& image, std::vector<LabelsOfBrick> mixed)
      : image_(image), bricks_(image.size), mixed_(std::move(mixed)), first_of_row_{0} {
    const auto length = bricks_.size()[0];
    for (auto row = image.label_of_brick.begin(); row != image.label_of_brick.end(); row += length) {
      const auto count = std::count(row, row + length, ImageByBricks::kMixed);
      first_of_row_.push_back(first_of_row_.back() + static_cast<std::size_t>(count));
    }
  }

  LabelImage read(const Voxel& low, const Voxel& high) const {
    LabelImage part = image_;
    part.size = {high.i - low.i, high.j - low.j, high.k - low.k};
    part.voxels.resize(part.num_voxels());
    for (int k = low.k / 4; 4 * k < high.k; ++k)
      for (int j = low.j / 4; 4 * j < high.j; ++j) read_row({low.i, 4 * j, 4 * k}, low, high, part);
    return part;
  }

 private:
  // Reads a row of bricks.
  void read_row(const Voxel& row, const Voxel& low, const Voxel& high, LabelImage& part) const {
    const std::size_t first = bricks_.index(0, row.j / 4, row.k / 4);
    std::size_t next = first_of_row_[first / unsigned_of(bricks_.size()[0])];
    for (int i = 0; 4 * i < high.i; ++i) {
      const LabelIndex label = image_.label_of_brick[first + unsigned_of(i)];
      const LabelsOfBrick* const mixed = label == ImageByBricks::kMixed ? &mixed_[next++] : nullptr;
      if (4 * i + 3 < low.i) continue;
      for (unsigned place = 0; place < 64; ++place) {
        const Voxel at{4 * i + static_cast<int>(place & 3) - low.i,
                       row.j + static_cast<int>(place >> 2 & 3) - low.j,
                       row.k + static_cast<int>(place >> 4) - low.k};
        const bool is_in = std::min({at.i, at.j, at.k}) >= 0 && at.i < part.size[0] && at.j < part.size[1] &&
                           at.k < part.size[2];
        if (is_in) part.voxels[part.index(at.i, at.j, at.k)] = mixed != nullptr ? (*mixed)[place] : label;
      }
    }
  }

  const ImageByBricks& image_;
  const BrickGrid bricks_;
  const std::vector<LabelsOfBrick> mixed_;
  std::vector<std::size_t> first_of_row_;  // positions in `mixed_`, by row of bricks
};

// A label and the number of consecutive bricks that have it.
struct Run {
  std::uint32_t label, length;
};

std::vector<Run> runs_of(const std::vector<LabelIndex>& labels) {
  std::vector<Run> runs;
  for (const LabelIndex label : labels) {
    if (runs.empty() || runs.back().label != label || runs.back().length == ~0u) runs.push_back({label, 0});
    ++runs.back().length;
  }
  return runs;
}

Bytes message_of(const Slab& slab) {
  Bytes message;
  append(message, runs_of(slab.label_of_brick));
  append(message, slab.mixed);
  std::string digests;
  for (const std::string& digest : slab.digests) digests += digest;
  append(message, std::span<const char>(digests));
  append(message, slab.census.voxels_of_label);
  append(message, std::span<const std::uint64_t>(slab.census.sides));
  append(message, std::span<const int>(slab.census.low));
  append(message, std::span<const int>(slab.census.high));
  return message;
}

// Adds the slab of the next rank.
void add_slab(const Bytes& message, Slab& sum) {
  constexpr std::size_t kHexadecimal = 64;
  MessageReader reader(message);
  for (const Run& run : reader.read<Run>())
    sum.label_of_brick.insert(sum.label_of_brick.end(), run.length, static_cast<LabelIndex>(run.label));
  const auto mixed = reader.read<LabelsOfBrick>();
  sum.mixed.insert(sum.mixed.end(), mixed.begin(), mixed.end());
  const std::vector<char> digests = reader.read<char>();
  for (std::size_t at = 0; at < digests.size(); at += kHexadecimal)
    sum.digests.emplace_back(digests.data() + at, kHexadecimal);
  Census census{.voxels_of_label = reader.read<std::uint64_t>(), .low = {}};
  std::ranges::copy(reader.read<std::uint64_t>(), census.sides.begin());
  std::ranges::copy(reader.read<int>(), census.low.begin());
  std::ranges::copy(reader.read<int>(), census.high.begin());
  reader.expect_end();
  sum.census += census;
}

std::shared_ptr<const ImageByBricks> image_of(LabelImage&& grid, std::shared_ptr<const VoxelFile> file,
                                              std::shared_ptr<const LabelsOfValues> labels,
                                              const std::vector<Bytes>& slabs) {
  auto image = std::make_shared<ImageByBricks>();
  static_cast<LabelImage&>(*image) = std::move(grid);
  image->path = file->path();
  Slab sum{
      .label_of_brick = {},
      .mixed = {},
      .digests = {},
      .census = {.voxels_of_label = std::vector<std::uint64_t>(image->labels.size()), .low = image->size}};
  for (const Bytes& message : slabs) add_slab(message, sum);
  image->label_of_brick = std::move(sum.label_of_brick);
  image->voxels_of_label = std::move(sum.census.voxels_of_label);
  image->low = sum.census.low;
  image->high = sum.census.high;
  image->sides = sum.census.sides;
  image->digest = digest_of_layers(sum.digests);
  if (file->is_compressed()) {
    const auto held = std::make_shared<const HeldBricks>(*image, std::move(sum.mixed));
    image->read = [held](const Voxel& low, const Voxel& high) { return held->read(low, high); };
    return image;
  }
  image->read = [file = std::move(file), labels = std::move(labels)](const Voxel& low, const Voxel& high) {
    LabelImage part = file->read(low, high, 1);
    labels->apply(file->path(), part, 1);
    return part;
  };
  return image;
}

void expect_one_file(const VoxelFile& file, Communication& ranks) {
  const LabelImage& grid = file.grid();
  expect_agreement({{"image", fmt::format("{} voxels of type {}, affine {}", fmt::join(grid.size, " x "),
                                          static_cast<int>(file.type()), fmt::join(grid.voxel_to_ras, " "))}},
                   ranks);
}

// Collective. Returns the values in the file.
std::vector<std::uint32_t> values_in(const VoxelFile& file, const Layers& slab, int threads,
                                     Communication& ranks) {
  std::set<std::uint32_t> own, all;
  const auto read = [&] {
    Slices slices(file, threads);
    for_each_chunk(file.grid(), slab, [&](const Layers& layers) {
      const LabelImage part = slices.read(4 * layers.first, 4 * layers.end);
      for (const Label& label : part.labels) own.insert(label.value);
    });
  };
  do_collectively(read, ranks);
  Bytes message;
  append(message, std::vector<std::uint32_t>(own.begin(), own.end()));
  for (const Bytes& received : ranks.all_gather(std::move(message)))
    for (const std::uint32_t value : MessageReader(received).read<std::uint32_t>()) all.insert(value);
  return {all.begin(), all.end()};
}

}  // namespace

bool can_stay_in_file(const LabelSelection& selection, const MeshingOptions& options) {
  const SizeOptions& sizes = options.sizes;
  return selection.drop_islands_mm3 == 0 && selection.layers.empty() && options.smoothing_mm == 0 &&
         sizes.grade == 0 && sizes.target_elements == 0 && options.team.executor != Executor::kVirtual;
}

std::shared_ptr<const LabelImage> read_by_bricks(const std::shared_ptr<const VoxelFile>& file,
                                                 const LabelSelection& selection, int threads,
                                                 std::uint64_t most_bytes, SharedValue<LabelImage>& shared,
                                                 Communication& ranks) {
  expect_one_file(*file, ranks);
  do_collectively([&] { check_room(file->path(), most_bytes_while_read(*file), most_bytes); }, ranks);
  const int num_layers = BrickGrid(file->grid().size).size()[2];
  const Layers own = !file->is_compressed() ? layers_of(ranks.rank(), ranks.size(), num_layers)
                                            : Layers{0, ranks.rank() == 0 ? num_layers : 0};
  const std::vector<std::uint32_t> values = values_in(*file, own, threads, ranks);
  LabelImage image = file->grid();
  std::shared_ptr<const LabelsOfValues> labels;
  Slab slab;
  const auto read = [&] {
    for (const std::uint32_t value : values) image.labels.push_back({value, {}});
    std::vector<LabelIndex> selected =
        select_among(image, selection, {values.begin(), values.end()}, file->path());
    selected.resize(values.size());
    labels = std::make_shared<const LabelsOfValues>(values, std::move(selected));
    slab = ReadSlab(*file, *labels, image.labels.size(), threads)(own);
  };
  do_collectively(read, ranks);
  const std::vector<Bytes> slabs = ranks.all_gather(message_of(slab));
  const auto make = [&] { return image_of(std::move(image), file, labels, slabs); };
  return shared.get(make, ranks);
}

}  // namespace podm
