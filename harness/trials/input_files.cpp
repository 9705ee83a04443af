#include "trials/input_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "errors.h"
#include "experiments/experiment.h"
#include "rows/results_file.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kTimeoutS = 600;
constexpr std::size_t kTailBytes = 2000, kMaxMarkBytes = 100;

// After "phantom:".
std::string name_and_size(const std::string& phantom) { return phantom.substr(phantom.find(':') + 1); }

ProcessRequest request_of(std::vector<std::string> arguments, const std::string& scratch_folder) {
  return {.arguments = std::move(arguments),
          .stdout_path = scratch_folder + "/stdout.txt",
          .stderr_path = scratch_folder + "/stderr.txt",
          .timeout_s = kTimeoutS};
}

}  // namespace

PreparationError::PreparationError(const std::string& what, const ProcessRequest& request,
                                   const ProcessOutcome& outcome)
    : std::runtime_error(fmt::format("{}: {}", what, outcome.describe())),
      command(request.arguments),
      process(outcome),
      stderr_tail(read_tail(request.stderr_path, kTailBytes)) {}

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

// Voxels along the longest axis.
std::string InputFiles::size_of(const std::string& phantom, const std::string& scratch_folder,
                                const StopQuery& stop_requested) const {
  if (const auto at = phantom.find('@'); at != std::string::npos) return phantom.substr(at + 1);
  const ProcessRequest request = request_of({podm_, "info", phantom, "--json"}, scratch_folder);
  const ProcessOutcome outcome = run_process(request, stop_requested);
  std::ifstream file(request.stdout_path);
  const auto info = nlohmann::ordered_json::parse(file, nullptr, false);
  if (!outcome.succeeded() || !info.is_object() || !info.value("size", nlohmann::ordered_json()).is_array())
    throw PreparationError(phantom + " has no size", request, outcome);
  int longest = 0;
  for (const auto& voxels : info["size"]) longest = std::max(longest, voxels.get<int>());
  return std::to_string(longest);
}

void InputFiles::draw(const std::string& phantom, const std::string& scratch_folder,
                      const StopQuery& stop_requested) const {
  const std::string name = name_and_size(phantom), aside = scratch_folder + "/phantom.nii.gz";
  const ProcessRequest request = request_of({podm_, "phantom", name.substr(0, name.find('@')), "--size",
                                             size_of(phantom, scratch_folder, stop_requested), "-o", aside},
                                            scratch_folder);
  const ProcessOutcome outcome = run_process(request, stop_requested);
  if (!outcome.succeeded() || !fs::exists(aside))
    throw PreparationError(phantom + " is not drawn", request, outcome);
  std::error_code error;
  fs::create_directories(folder_, error);
  fs::rename(aside, path_of(phantom), error);
  if (error) throw InputError(fmt::format("cannot write {}: {}", path_of(phantom), error.message()));
  write_file(mark_of(phantom), podm_sha256_ + "\n");
}

}  // namespace podm::bench
