#include "python/mesh_in_memory.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "algorithms/team_size.h"
#include "cli/commands/labelled_image.h"
#include "cli/commands/verify_mesh.h"
#include "cli/options/options_for_image.h"
#include "cli/processes/process_memory.h"
#include "cli/reports/json_text.h"
#include "cli/reports/record.h"
#include "podm/mesh_io.h"

namespace podm::python {

MeshInMemory::MeshInMemory(cli::MeshCommand command, const Input& input, const ProgressCallback& progress,
                           const std::stop_token& stop)
    : command_(std::move(command)),
      run_{.command = command_,
           .image = image_,
           .options = {},
           .report = {},
           .mesh = {},
           .mesh_sha256 = {},
           .verification = nullptr} {
  command_.image.path = input.path;
  command_.image.is_array = input.array.has_value();
  const std::uint64_t limit_bytes = cli::memory_limit_bytes(command_);
  const auto start = std::chrono::steady_clock::now();
  image_ = read_input(input, command_, limit_bytes);
  image_.is_box_flat = command_.meshing.box == BoxFaces::kFlat;
  run_.read_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run_.options = cli::options_for_image(command_, image_, limit_bytes);
  MeshingResult result = mesh_image(image_, run_.options, progress, stop);
  mesh_ = std::move(result.mesh);
  run_.take(std::move(result.report), mesh_);
  if (!command_.image.is_array && !command_.image.is_phantom()) image_.voxels = {};  // the file holds them
  canonicalize(mesh_, loop_threads(command_.meshing.team));
  run_.peak_rss_bytes = cli::peak_resident_bytes();
}

LabelImage read_input(const Input& input, const cli::MeshCommand& command, std::uint64_t limit_bytes) {
  const int threads = loop_threads(command.meshing.team);
  const std::uint64_t most_bytes = cli::bytes_for_image(limit_bytes);
  LabelSelection selection = cli::with_table(command.image);
  for (const auto& [value, name] : input.names) selection.table.push_back({value, name});
  return input.array
             ? image_of_array(*input.array, input.voxel_to_ras, input.path, selection, threads, most_bytes)
             : read_image(command.image.path, selection, threads, most_bytes);
}

std::string MeshInMemory::record() {
  if (run_.mesh_sha256.empty()) run_.mesh_sha256 = mesh_sha256(mesh_);
  return cli::json_line(cli::record(run_));
}

std::vector<std::string> MeshInMemory::claims(bool with_fidelity,
                                              const std::function<std::string()>& write_image) {
  command_.verify_fidelity = with_fidelity;
  return cli::verifier_options(run_, write_image);
}

}  // namespace podm::python
