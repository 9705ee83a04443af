#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "errors.h"

namespace podm::bench {

/// A new folder for the files of one trial. It is removed with its files unless it is kept. A folder of
/// results has one at a time; files that a killed run left there are removed.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& results_folder) : path_(results_folder + "/.running") {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
    if (!std::filesystem::create_directory(path_, error))
      throw InputError(fmt::format("cannot make the folder {}: {}", path_, error.message()));
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

  /// Moves the folder to `kept_path` and replaces any folder there. Throws InputError.
  void keep(const std::string& kept_path) const {
    std::error_code error;
    std::filesystem::remove_all(kept_path, error);
    std::filesystem::rename(path_, kept_path, error);
    if (error) throw InputError(fmt::format("cannot keep {}: {}", kept_path, error.message()));
  }

 private:
  std::string path_;
};

}  // namespace podm::bench
