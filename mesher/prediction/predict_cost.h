// Predicts the cost of a run: cells and memory by models of the image, seconds by the time that this machine
// presently takes for a mesh of a phantom.
#pragma once

#include <optional>
#include <vector>

#include "isosurface/isosurface.h"
#include "podm/mesh_image.h"
#include "sizing/thin_layers.h"

namespace podm {

struct Cost {
  SizeOptions sizes;                   ///< with the radius and delta of the run
  std::vector<double> cells_of_label;  ///< by position in LabelImage::labels; 0 for the background
  double cells = 0;                    ///< of the mesh
  double stored_cells = 0;             ///< includes the background; determines memory and seconds
  double mesh_bytes = 0;               ///< at the peak, without image and transform
  std::optional<ThinLayers> layers;    ///< that the run keeps
  double growth_at_layers = 1;         ///< of all numbers of cells, which include it
  double mesh_s = 0;                   ///< of all phases after the transform, including output
};

/// Predicts the cost of mesh_image() with these options. Relevant are the sizes, the team, the algorithm and
/// the options for dihedral angles. Meshes about 10^5 cells of a phantom, which takes less than a second on
/// the same threads. The image itself is not meshed. scripts/check_plan compares predictions with runs of
/// eight segmentations. Throws InputError as mesh_image() does.
Cost predict_cost(const LabelImage& image, const MeshingOptions& options);

/// A clock for work on a number of threads. Work of one thread is timed by the processor time of the process,
/// which other load of the machine does not lengthen. Work of several threads is timed by the wall clock.
class WorkTimer {
 public:
  explicit WorkTimer(int threads) : threads_(threads), start_s_(now_s()) {}
  double seconds() const { return now_s() - start_s_; }

 private:
  double now_s() const;

  int threads_;
  double start_s_;
};

}  // namespace podm
