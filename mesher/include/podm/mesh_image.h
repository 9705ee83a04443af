// The whole public API of the mesher: a label image in, a tetrahedral mesh with guarantees out.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "podm/errors.h"
#include "podm/label_image.h"
#include "podm/meshing_options.h"
#include "podm/meshing_report.h"
#include "podm/tet_mesh.h"

namespace podm {

struct OperationLog;

/// What a run is expected to cost, from the image and the options alone.
struct Estimate {
  double cells = 0;
  double memory_bytes = 0;  ///< peak of the whole process
  double delta_mm =
      0;  ///< the surface sampling distance; 0 where it follows from a target number of elements
};

struct Progress {
  std::string phase;        ///< "transform", "refine", "optimize", "extract", "measure"
  double fraction = 0;      ///< an estimate for the phase, in [0,1]
  std::uint64_t cells = 0;  ///< so far
  double seconds = 0;       ///< since the start of the run
};
/// Called from the meshing thread a few times a second.
using ProgressCallback = std::function<void(const Progress&)>;

struct MeshingResult {
  TetMesh mesh;
  MeshingReport report;
};

/// Default surface sampling distance for an image and a radius (mm; radius 0: unbounded), mm.
double default_delta_mm(const LabelImage& image, double radius_mm);

/// Expected cells and memory of mesh_image with these options (target_elements resolved).
Estimate estimate(const LabelImage& image, const MeshingOptions& options);

/// Meshes `image`. Throws InputError on bad options or an image without foreground, std::bad_alloc when
/// memory runs out. A stop request or a limit ends the run early with a valid mesh; see stop_reason.
/// Rules and proofs: Foteinos, Chernikov, Chrisochoides, CGTA 47 (2014) 539-562.
MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress = {}, std::stop_token stop = {});

/// The mesh that the logged operations make one after the other: the serial run that a parallel run claims to
/// equal. Throws InputError, naming the operation, when one cannot be carried out as logged.
TetMesh replay_operations(const LabelImage& image, const OperationLog& log, Space space);

}  // namespace podm
