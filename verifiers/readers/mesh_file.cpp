#include "readers/mesh_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "errors.h"

namespace podm::verify {
namespace {

constexpr std::size_t kStepBytes = 1 << 20;

class FileDescriptor {
 public:
  explicit FileDescriptor(const std::string& path) : number_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~FileDescriptor() {
    if (number_ >= 0) ::close(number_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

struct CloseGzip {
  void operator()(gzFile file) const { gzclose_r(file); }
};

[[noreturn]] void refuse_file(const std::string& path, const std::string& fault) {
  throw InputError(path + ": " + fault);
}

}  // namespace

MeshFile::MeshFile(const std::string& path) : path_(path), is_gzipped_(path.ends_with(".gz")) {
  map();
  if (is_gzipped_) inflate();
}

MeshFile::~MeshFile() {
  if (mapping_ != nullptr) ::munmap(mapping_, bytes_.size());
}

void MeshFile::map() {
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0) refuse_file(path_, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) refuse_file(path_, "not a regular file");
  if (status.st_size == 0) refuse_file(path_, "the file is empty");
  const FileDescriptor file(path_);
  if (file.number() < 0) refuse_file(path_, std::strerror(errno));
  const auto size = static_cast<std::size_t>(status.st_size);
  void* mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number(), 0);
  if (mapping == MAP_FAILED) refuse_file(path_, std::strerror(errno));
  mapping_ = mapping;
  bytes_ = {static_cast<const char*>(mapping), size};
}

void MeshFile::inflate() {
  if (!bytes_.starts_with("\x1f\x8b")) refuse("byte 0", "the name ends in .gz, the content is not gzip's");
  ::munmap(mapping_, bytes_.size());
  mapping_ = nullptr;
  const std::unique_ptr<gzFile_s, CloseGzip> file(gzopen(path_.c_str(), "rb"));
  if (!file) refuse_file(path_, "cannot be opened for reading");
  while (true) {
    const int count = gzread(file.get(), inflated_.extend(kStepBytes), kStepBytes);
    inflated_.shrink(inflated_.size() - kStepBytes + static_cast<std::size_t>(std::max(count, 0)));
    int code = Z_OK;
    const char* message = gzerror(file.get(), &code);
    if (code != Z_OK) refuse(byte_at(inflated_.size()) + " of the inflated content", message);
    if (count == 0) break;
  }
  bytes_ = inflated_.view();
  if (bytes_.empty()) refuse_file(path_, "the file is empty");
}

void MeshFile::refuse(const std::string& place, const std::string& fault) const {
  throw InputError(fmt::format("{}: {}: {}", path_, place, fault));
}

std::string MeshFile::line_at(std::size_t position) const {
  const std::string_view before = bytes_.substr(0, position);
  return fmt::format("line {}", std::count(before.begin(), before.end(), '\n') + 1);
}

std::string MeshFile::byte_at(std::size_t position) { return fmt::format("byte {}", position); }

}  // namespace podm::verify
