#include "files/atomic_file.h"

#include <array>
#include <vector>

namespace podm {

AtomicFile::AtomicFile(const std::string& path) : file_(path), buffer_(new char[kBufferBytes]) {}

void AtomicFile::write(const void* bytes, std::size_t size) {
  if (size == 0) return;  // `bytes` may then be null, which memcpy does not allow
  const char* from = static_cast<const char*>(bytes);
  if (buffered_ + size > kBufferBytes) flush();
  if (size > kBufferBytes) return file_.write(from, size);
  std::memcpy(buffer_.get() + buffered_, from, size);
  buffered_ += size;
}

void AtomicFile::flush() {
  file_.write(buffer_.get(), buffered_);
  buffered_ = 0;
}

void AtomicFile::finish() {
  flush();
  file_.finish();
  buffer_.reset();
}

void AtomicFile::publish() {
  finish();
  TemporaryFile::publish(std::array{&file_});
}

void publish_together(std::deque<AtomicFile>& files) {
  std::vector<TemporaryFile*> temporaries;
  for (AtomicFile& file : files) {
    file.finish();
    temporaries.push_back(&file.file_);
  }
  TemporaryFile::publish(temporaries);
}

}  // namespace podm
