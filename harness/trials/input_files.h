// Images as files. A phantom is drawn into one once, so that what a trial reads costs what reading costs.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "process/process.h"

namespace podm::bench {

inline constexpr const char* kRecordName = "/record.jsonl";  ///< the mesher's, in the folder of a trial

/// Why a trial cannot start; its row tells it.
class PreparationError : public std::runtime_error {
 public:
  /// `what` was to be made by the command, which ended with `outcome` and these last words on stderr.
  PreparationError(const std::string& what, std::vector<std::string> command, const ProcessOutcome& outcome,
                   std::string stderr_tail);

  std::vector<std::string> command;
  ProcessOutcome process;
  std::string stderr_tail;
};

/// Phantoms are NAME.nii.gz or NAME@SIZE.nii.gz in a folder. Beside each, NAME.mesher holds the hash of the
/// mesher that drew it: another draws it anew.
class InputFiles {
 public:
  InputFiles(std::string podm, std::string podm_sha256, std::string folder)
      : podm_(std::move(podm)), podm_sha256_(std::move(podm_sha256)), folder_(std::move(folder)) {}

  /// The image itself where it is a file.
  std::string path_of(const std::string& image) const;
  /// Whether this mesher has drawn the phantom. A file is taken to be there: reading it tells.
  bool is_there(const std::string& image) const;
  /// Draws a phantom, in the mesher's own size where it names none. Throws PreparationError.
  void draw(const std::string& phantom, const std::string& scratch_folder,
            const StopQuery& stop_requested) const;

 private:
  std::string mark_of(const std::string& phantom) const;
  std::string size_of(const std::string& phantom, const StopQuery& stop_requested) const;

  std::string podm_, podm_sha256_, folder_;
};

}  // namespace podm::bench
