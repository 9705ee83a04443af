#include "trials/input_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "errors.h"
#include "options/trial_settings.h"
#include "rows/results_file.h"
#include "trials/image_info.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kDrawingTimeoutS = 600;
constexpr std::size_t kMaxMarkBytes = 100;

// The part of the name after "phantom:".
std::string name_and_size(const std::string& phantom) { return phantom.substr(phantom.find(':') + 1); }

}  // namespace

PreparationError::PreparationError(const std::string& what, std::vector<std::string> failed,
                                   const ProcessOutcome& outcome, std::string last_words)
    : std::runtime_error(fmt::format("{}: {}", what, outcome.describe())),
      command(std::move(failed)),
      process(outcome),
      stderr_tail(std::move(last_words)) {}

std::string InputFiles::path_of(const std::string& image) const {
  return is_phantom(image) ? fmt::format("{}/{}.nii.gz", folder_, name_and_size(image)) : image;
}

std::string InputFiles::mark_of(const std::string& phantom) const {
  return fmt::format("{}/{}.mesher", folder_, name_and_size(phantom));
}

bool InputFiles::is_there(const std::string& image) const {
  return !is_phantom(image) ||
         (fs::exists(path_of(image)) && read_tail(mark_of(image), kMaxMarkBytes) == podm_sha256_ + "\n");
}

// Returns the number of voxels along the longest axis.
std::string InputFiles::size_of(const std::string& phantom, const StopQuery& stop_requested) const {
  if (const auto at = phantom.find('@'); at != std::string::npos) return phantom.substr(at + 1);
  const ImageInfo info = ask_for_info(podm_, phantom, stop_requested);
  if (!info.size)
    throw PreparationError(phantom + " has no size", info.command, info.reply.outcome, info.reply.messages);
  return std::to_string(std::ranges::max(*info.size));
}

void InputFiles::draw(const std::string& phantom, const std::string& scratch_folder,
                      const StopQuery& stop_requested) const {
  const std::string name = name_and_size(phantom), aside = scratch_folder + "/phantom.nii.gz";
  const std::vector<std::string> command{
      podm_, "phantom", name.substr(0, name.find('@')), "--size", size_of(phantom, stop_requested),
      "-o",  aside};
  const Reply reply = ask(command, kDrawingTimeoutS, stop_requested);
  if (!reply.succeeded() || !fs::exists(aside))
    throw PreparationError(phantom + " is not drawn", command, reply.outcome, reply.messages);
  std::error_code error;
  fs::create_directories(folder_, error);
  fs::rename(aside, path_of(phantom), error);
  if (error) throw InputError(fmt::format("cannot write {}: {}", path_of(phantom), error.message()));
  write_file(mark_of(phantom), podm_sha256_ + "\n");
}

}  // namespace podm::bench
