#include "rows/results_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "rows/codec.h"

namespace podm::bench {
namespace {

// Returns 0 or the number of the error.
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

int open_to_append(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(path, errno);
  return descriptor;
}

// Throws InputError that names the line.
Row row_of(const Json& json, const std::string& path, std::size_t line) {
  const Json schema = json.value("schema", Json());
  if (schema != kRowSchema)
    throw InputError(fmt::format("{}:{}: a row of schema {}; this program reads {}: move the file away", path,
                                 line, schema.is_null() ? "none" : schema.dump(), kRowSchema));
  try {
    return from_json<Row>(json);
  } catch (const FieldError& fault) {
    throw InputError(fmt::format("{}:{}: {}", path, line, fault.what()));
  }
}

}  // namespace

ResultsLock::ResultsLock(const std::string& folder) {
  std::error_code error;  // open() reports a missing folder
  std::filesystem::create_directories(folder, error);
  const std::string path = folder + "/.lock";
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(path, errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int error_number = errno;
  ::close(descriptor_);
  throw InputError(fmt::format("{} is {}", path,
                               error_number == EWOULDBLOCK ? "locked: another run writes into this folder"
                                                           : std::strerror(error_number)));
}

ResultsLock::~ResultsLock() { ::close(descriptor_); }

RowsRead read_rows(const std::string& path) {
  RowsRead read;
  std::ifstream file(path);
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const Json json = Json::parse(line, nullptr, false);
    if (json.is_object()) {
      read.rows.push_back(row_of(json, path, number));
      read.whole += line + "\n";
      continue;
    }
    if (read.broken_line == 0) read.broken_line = number;
    read.broken += line + "\n";
  }
  return read;
}

RowsRead repair_rows(const std::string& path) {
  RowsRead read = read_rows(path);
  if (!read.broken.empty()) RecordFile(path + ".broken").append_text(read.broken);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (!error && size != read.whole.size()) write_file(path, read.whole);  // also if the last end is missing
  return read;
}

void write_file(const std::string& path, const std::string& text) {
  const std::string aside = path + ".new";
  const int descriptor = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(aside, errno);
  const int error_number = write_all(descriptor, text);
  ::close(descriptor);
  if (error_number != 0) fail(aside, error_number);
  if (::rename(aside.c_str(), path.c_str()) != 0) fail(path, errno);
}

RecordFile::RecordFile(const std::string& path) : path_(path), descriptor_(open_to_append(path)) {}

RecordFile::~RecordFile() { ::close(descriptor_); }

std::string as_line(const Row& row) {
  return to_json(row).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void RecordFile::replace_newest(const std::vector<Row>& rows) {
  std::map<std::string, const Row*> awaited;
  for (const Row& row : rows) awaited[row.key] = &row;
  std::vector<std::string> lines;
  std::ifstream file(path_);
  for (std::string line; std::getline(file, line);) lines.push_back(line + "\n");
  for (auto line = lines.rbegin(); line != lines.rend() && !awaited.empty(); ++line) {
    const Json json = Json::parse(*line, nullptr, false);
    const auto found = awaited.find(json.is_object() ? json.value("key", "") : "");
    if (found == awaited.end()) continue;
    *line = as_line(*found->second);
    awaited.erase(found);
  }
  write_file(path_, fmt::format("{}", fmt::join(lines, "")));
  ::close(descriptor_);  // the descriptor of the replaced file
  descriptor_ = open_to_append(path_);
}

void RecordFile::append_text(const std::string& text) {
  struct stat before {};
  int error_number = ::fstat(descriptor_, &before) == 0 ? write_all(descriptor_, text) : errno;
  if (error_number != 0 && ::ftruncate(descriptor_, before.st_size) != 0) error_number = errno;
  if (error_number != 0) fail(path_, error_number);
}

}  // namespace podm::bench
