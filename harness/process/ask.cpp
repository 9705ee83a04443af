#include "process/ask.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace podm::bench {
namespace {

constexpr std::size_t kMaxReplyBytes = std::size_t{1} << 20, kMaxMessageBytes = 2000;

// A nameless file in memory. A child can open it by its path until the child executes its program.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("reply", MFD_CLOEXEC)) {
    // The child replaces its first three descriptors.
    if (descriptor_ >= 0 && descriptor_ <= STDERR_FILENO) {
      const int low = descriptor_;
      descriptor_ = fcntl(low, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
      close(low);
    }
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "memfd_create");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

std::string without_last_line_ends(const std::string& text) {
  return text.substr(0, text.find_last_not_of('\n') + 1);
}

}  // namespace

std::string Reply::error_text() const {
  std::string line = without_last_line_ends(messages);
  for (std::size_t end = 0; (end = line.find('\n', end)) != std::string::npos; end += 2)
    line.replace(end, 1, "; ");
  return line;
}

std::string Reply::failure_text() const {
  return messages.empty() ? outcome.describe() : fmt::format("{}: {}", outcome.describe(), error_text());
}

Reply ask(const std::vector<std::string>& arguments, double timeout_s, const StopQuery& stop_requested) {
  const MemoryFile output, errors;
  Reply reply;
  reply.outcome = run_process({.arguments = arguments,
                               .stdout_path = output.path(),
                               .stderr_path = errors.path(),
                               .timeout_s = timeout_s},
                              stop_requested);
  reply.text = without_last_line_ends(read_tail(output.path(), kMaxReplyBytes));
  reply.messages = read_tail(errors.path(), kMaxMessageBytes);
  return reply;
}

}  // namespace podm::bench
