#include "trials/trial_logs.h"

#include <fmt/format.h>

#include <filesystem>

#include "errors.h"

namespace podm::bench {

namespace fs = std::filesystem;

std::string logs_folder(const std::string& results_folder, const std::string& key) {
  return fmt::format("{}/logs/{}", results_folder, key);
}

void keep_logs(const std::string& scratch_folder, const std::string& results_folder, const std::string& key) {
  const std::string folder = logs_folder(results_folder, key);
  std::error_code error;
  fs::remove_all(folder, error);
  fs::create_directories(folder, error);
  for (const char* name : kLogNames)
    if (!error && fs::exists(scratch_folder + name))
      fs::copy_file(scratch_folder + name, folder + name, error);
  if (error) throw InputError(fmt::format("cannot write {}: {}", folder, error.message()));
}

}  // namespace podm::bench
