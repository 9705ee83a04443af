// The whole public API of the mesher: takes a label image and returns a tetrahedral mesh with guarantees.
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

/// The expected cost of a run, predicted from the image and the options alone.
struct Estimate {
  double cells = 0;
  double memory_bytes = 0;  ///< peak memory of the whole process
  /// Surface sampling distance; 0 if it depends on a target number of elements.
  double delta_mm = 0;
};

struct Progress {
  std::string phase;        ///< "transform", "smooth", "refine", "perturb", "optimize", "extract", "measure"
  double fraction = 0;      ///< estimated fraction of the phase, in [0,1]
  std::uint64_t cells = 0;  ///< current number
  double seconds = 0;       ///< since the start of the run
};
/// The meshing thread calls it a few times per second.
using ProgressCallback = std::function<void(const Progress&)>;

struct MeshingResult {
  TetMesh mesh;
  MeshingReport report;
};

/// Returns the default surface sampling distance, mm, for an image and a radius (mm; 0: unbounded).
double default_delta_mm(const LabelImage& image, double radius_mm);

/// Returns the expected cells and memory of mesh_image() with these options; resolves target_elements.
Estimate estimate(const LabelImage& image, const MeshingOptions& options);

/// Meshes `image`. Throws InputError on bad options or an image without foreground, and std::bad_alloc when
/// memory runs out. A stop request or a limit ends the run early with a valid mesh; see stop_reason. Rules
/// and proofs: Foteinos, Chernikov, Chrisochoides, CGTA 47 (2014) 539-562.
MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress = {}, std::stop_token stop = {});

/// Returns the mesh that the logged operations make one after the other: the serial run that a parallel run
/// claims to equal. Throws InputError that names the operation if an operation cannot be replayed as logged.
TetMesh replay_operations(const LabelImage& image, const OperationLog& log, Space space);

}  // namespace podm
