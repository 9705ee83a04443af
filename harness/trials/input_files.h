// Images as files. A phantom is drawn into a file once; each trial then pays for reading, not for drawing.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "process/process.h"

namespace podm::bench {

inline constexpr const char* kRecordName = "/record.jsonl";  ///< the mesher's record of a trial

/// The reason why a trial cannot start, which its row records.
class PreparationError : public std::runtime_error {
 public:
  /// The command should have made `what`. It ended with `outcome` and with this end of its stderr.
  PreparationError(const std::string& what, std::vector<std::string> command, const ProcessOutcome& outcome,
                   std::string stderr_tail);

  std::vector<std::string> command;
  ProcessOutcome process;
  std::string stderr_tail;
};

/// Phantoms are files NAME.nii.gz or NAME@SIZE.nii.gz in a folder. NAME.mesher beside each holds the hash of
/// the mesher that drew it. Another mesher draws it anew.
class InputFiles {
 public:
  InputFiles(std::string podm, std::string podm_sha256, std::string folder)
      : podm_(std::move(podm)), podm_sha256_(std::move(podm_sha256)), folder_(std::move(folder)) {}

  /// Returns the file of the phantom, or the image itself if it is a file.
  std::string path_of(const std::string& image) const;
  /// True if this mesher has drawn the phantom. True for a file, because reading it reports its absence.
  bool is_there(const std::string& image) const;
  /// Draws a phantom, in the mesher's default size if the name has no size. Throws PreparationError.
  void draw(const std::string& phantom, const std::string& scratch_folder,
            const StopQuery& stop_requested) const;

 private:
  std::string mark_of(const std::string& phantom) const;
  std::string size_of(const std::string& phantom, const StopQuery& stop_requested) const;

  std::string podm_, podm_sha256_, folder_;
};

}  // namespace podm::bench
