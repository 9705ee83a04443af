// A run of the mesher whose image and mesh stay in memory: what a podm.Mesh of Python looks at.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "cli/commands/mesh_run.h"
#include "cli/options/options.h"
#include "podm/image_io.h"
#include "podm/mesh_image.h"

namespace podm::python {

/// What is meshed: a file or a phantom by its name, or an array.
struct Input {
  std::string path;  ///< of an array what messages call it
  std::optional<VoxelArray> array = {};
  std::array<double, 12> voxel_to_ras{};  ///< the array's, row-major 3x4, mm
  std::map<std::uint32_t, std::string> names = {};
};

/// The image as `podm mesh` reads it with these options; `command` knows its path. Throws InputError.
LabelImage read_input(const Input& input, const cli::MeshCommand& command, std::uint64_t limit_bytes);

class MeshInMemory {
 public:
  /// Meshes as `podm mesh` does with these options, and throws what that throws.
  MeshInMemory(cli::MeshCommand command, const Input& input, const ProgressCallback& progress,
               const std::stop_token& stop);
  MeshInMemory(const MeshInMemory&) = delete;
  MeshInMemory& operator=(const MeshInMemory&) = delete;

  const cli::MeshRun& run() const { return run_; }
  /// In canonical order.
  const TetMesh& mesh() const { return mesh_; }
  /// Of an array or a phantom; of a file all but the voxels.
  const LabelImage& image() const { return image_; }

  /// The JSON that --record appends. The first call hashes image and mesh.
  std::string record();
  /// What podm-verify is to be asked; see claims_to_verify().
  std::vector<std::string> claims(bool with_fidelity, const std::function<std::string()>& write_image);

 private:
  cli::MeshCommand command_;
  LabelImage image_;
  TetMesh mesh_;
  cli::MeshRun run_;
};

}  // namespace podm::python
