#include "process/share.h"

#include <filesystem>

namespace podm::bench {
namespace {

std::filesystem::path folder_of_this_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

}  // namespace

std::string beside_this_program(const std::string& name) {
  return (folder_of_this_program() / name).string();
}

std::string share_of_this_program(const std::string& name) {
  return (folder_of_this_program().parent_path() / PODM_BENCH_SHARE / name).string();
}

}  // namespace podm::bench
