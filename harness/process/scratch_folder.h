#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "errors.h"

namespace podm::bench {

/// A new folder for the files of one trial, gone with all it holds unless kept. There is one at a time in a
/// folder of results; what a killed run left in it is removed.
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

  /// Moves it to `kept_path`, in place of what is there. Throws InputError.
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
