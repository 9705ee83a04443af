#include "files/leftovers.h"

#include <unistd.h>

#include <filesystem>
#include <set>
#include <system_error>

namespace podm {
namespace {

struct Leftovers {
  std::mutex mutex;
  std::set<std::string> paths;
};

// Never destroyed: threads may come here while the process ends.
Leftovers& leftovers() {
  static Leftovers& only = *new Leftovers;
  return only;
}

void remove_file_or_folder(const std::string& path) noexcept try {
  if (::unlink(path.c_str()) == 0) return;  // which takes no memory
  std::error_code error;
  std::filesystem::remove_all(path, error);
} catch (const std::bad_alloc&) {  // the others may go
}

}  // namespace

HeldLeftovers::HeldLeftovers() : lock_(leftovers().mutex) {}

void HeldLeftovers::add(const std::string& path) { leftovers().paths.insert(path); }

void HeldLeftovers::drop(const std::string& path) { leftovers().paths.erase(path); }

bool HeldLeftovers::has(const std::string& path) const { return leftovers().paths.contains(path); }

void remove_leftovers_for_good() noexcept {
  leftovers().mutex.lock();
  for (const std::string& path : leftovers().paths) remove_file_or_folder(path);
}

}  // namespace podm
