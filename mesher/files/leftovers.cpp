#include "files/leftovers.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <set>
#include <system_error>
#include <thread>

namespace podm {
namespace {

constexpr auto kPause = std::chrono::milliseconds(5);
constexpr int kMostPauses = 100;  // half a second

struct Leftovers {
  std::mutex mutex;
  std::set<std::string> paths;
  std::set<pid_t> children;
};

// Never destroyed, because threads may use them while the process ends.
Leftovers& leftovers() {
  static Leftovers& only = *new Leftovers;
  return only;
}

// Holds the leftovers and never releases them. Returns false if another thread held them for too long.
bool hold_leftovers() {
  for (int pause = 0; pause < kMostPauses; ++pause) {
    if (leftovers().mutex.try_lock()) return true;
    std::this_thread::sleep_for(kPause);
  }
  return false;
}

}  // namespace

HeldLeftovers::HeldLeftovers() : lock_(leftovers().mutex) {}

void HeldLeftovers::add(const std::string& path) { leftovers().paths.insert(path); }

void HeldLeftovers::drop(const std::string& path) { leftovers().paths.erase(path); }

bool HeldLeftovers::has(const std::string& path) const { return leftovers().paths.contains(path); }

void HeldLeftovers::add_child(pid_t child) { leftovers().children.insert(child); }

void HeldLeftovers::drop_child(pid_t child) { leftovers().children.erase(child); }

void remove_leftovers_for_good() noexcept {
  if (!hold_leftovers()) return;
  for (const pid_t child : leftovers().children) ::kill(child, SIGKILL);
  for (const std::string& path : leftovers().paths) remove_file_or_folder(path);
}

void remove_file_or_folder(const std::string& path) noexcept try {
  if (::unlink(path.c_str()) == 0) return;  // unlink() allocates no memory
  std::error_code error;
  std::filesystem::remove_all(path, error);
} catch (const std::bad_alloc&) {  // the other paths may still be removed
}

}  // namespace podm
