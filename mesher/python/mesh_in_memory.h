// A run of the mesher whose image and mesh stay in memory. A podm.Mesh of Python refers to it.
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

/// The input: the name of a file or a phantom, or an array.
struct Input {
  std::string path;  ///< for an array, its name in messages
  std::optional<VoxelArray> array = {};
  std::array<double, 12> voxel_to_ras{};  ///< of the array, row-major 3x4, mm
  std::map<std::uint32_t, std::string> names = {};
};

/// Reads the image as `podm mesh` does with these options. `command` holds the path. Throws InputError.
LabelImage read_input(const Input& input, const cli::MeshCommand& command, std::uint64_t limit_bytes);

class MeshInMemory {
 public:
  /// Meshes as `podm mesh` does with these options. Throws as `podm mesh` does.
  MeshInMemory(cli::MeshCommand command, const Input& input, const ProgressCallback& progress,
               const std::stop_token& stop);
  MeshInMemory(const MeshInMemory&) = delete;
  MeshInMemory& operator=(const MeshInMemory&) = delete;

  const cli::MeshRun& run() const { return run_; }
  /// Returns the mesh in canonical order.
  const TetMesh& mesh() const { return mesh_; }
  /// Returns the image. For a file, the voxels are not kept.
  const LabelImage& image() const { return image_; }

  /// Returns the JSON that --record appends. The first call hashes image and mesh.
  std::string record();
  /// Returns the options for podm-verify; see claims_to_verify().
  std::vector<std::string> claims(bool with_fidelity, const std::function<std::string()>& write_image);

 private:
  cli::MeshCommand command_;
  LabelImage image_;
  TetMesh mesh_;
  cli::MeshRun run_;
};

}  // namespace podm::python
