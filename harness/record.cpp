#include "record.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kImageBytesPerVoxel = 2 + 4;  // its label and its feature transform

Json process_of(const Trial& trial, const TrialResult& result) {
  using End = ProcessOutcome::End;
  const ProcessOutcome& process = result.process;
  const auto memory = bytes_per_cell_beyond_image(result);
  return {{"exit_code", process.end == End::kExited ? Json(process.exit_code) : Json()},
          {"signal", process.end == End::kSignalled ? Json(process.signal) : Json()},
          {"timeout_s", trial.timeout_s},
          {"wall_s", process.wall_s},
          {"user_s", process.user_s},
          {"system_s", process.system_s},
          {"peak_rss_bytes", process.peak_rss_bytes},
          {"bytes_per_cell_beyond_image", memory ? Json(*memory) : Json()}};
}

// 0 or the number of the error.
int write_all(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  return ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;  // EINVAL: a pipe or a terminal
}

[[noreturn]] void fail(const std::string& path, int error_number) {
  throw InputError(fmt::format("cannot write {}: {}", path, std::strerror(error_number)));
}

}  // namespace

std::optional<double> bytes_per_cell_beyond_image(const TrialResult& result) {
  if (!result.record.is_object() || !result.image_size.is_array()) return {};
  const double cells = result.record["cells"];
  if (cells == 0) return {};
  double image_bytes = kImageBytesPerVoxel;
  for (const auto& voxels : result.image_size) image_bytes *= voxels.get<double>();
  return (static_cast<double>(result.process.peak_rss_bytes) - image_bytes) / cells;
}

Json make_row(const Experiment& experiment, const Trial& trial, const TrialResult& result,
              const Json& environment) {
  Json row = {{"schema", kRecordSchema},
              {"experiment", experiment.name},
              {"trial", trial.name},
              {"status", to_string(result.status)},
              {"reason", result.reason},
              {"command", result.command},
              {"input", {{"path", trial.image}}}};
  if (result.record.is_object()) row.update(result.record);
  row["input"]["size"] = result.image_size;
  row["process"] = process_of(trial, result);
  row["stderr_tail"] = result.stderr_tail;
  row["environment"] = environment;
  return row;
}

RecordFile::RecordFile(const std::string& path)
    : path_(path), descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(path_, errno);
}

RecordFile::~RecordFile() { ::close(descriptor_); }

void RecordFile::append(const Json& row) {
  // stderr may hold any bytes; what is not UTF-8 is replaced.
  const std::string line = row.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  ::flock(descriptor_, LOCK_EX);  // two benches may share the file
  struct stat before {};
  int error_number = ::fstat(descriptor_, &before) == 0 ? write_all(descriptor_, line) : errno;
  if (error_number != 0 && ::ftruncate(descriptor_, before.st_size) != 0) error_number = errno;
  ::flock(descriptor_, LOCK_UN);
  if (error_number != 0) fail(path_, error_number);
}

}  // namespace podm::bench
