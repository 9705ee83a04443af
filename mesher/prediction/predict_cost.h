// What a run will cost, before it: cells and memory by models of the image, seconds by what this machine
// takes for a mesh of a phantom now.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "isosurface/isosurface.h"
#include "podm/mesh_image.h"

namespace podm {

struct Cost {
  SizeOptions sizes;                   ///< with radius and delta as the run will use them
  std::vector<double> cells_of_label;  ///< by position in LabelImage::labels; the background has none
  double cells = 0;                    ///< of the mesh
  double stored_cells = 0;             ///< the background's, too: what memory and seconds go by
  double mesh_bytes = 0;               ///< at the peak, image and transform apart
  double mesh_s = 0;                   ///< of all phases after the transform, writing among them
};

/// Predicts what mesh_image() makes of these options, of which size, team, algorithm and what is done about
/// dihedral angles count. Meshes some 10^5 cells of a phantom, for less than a second on the same threads;
/// the image is not meshed. Measured against runs of eight segmentations: see scripts/check_plan. Throws
/// InputError as mesh_image() does.
Cost predict_cost(const LabelImage& image, const MeshingOptions& options);

/// A clock for work on so many threads: one thread's work is timed by the processor time of the process,
/// which other load of the machine does not lengthen, that of several on the wall.
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
