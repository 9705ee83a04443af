// The options of a run: claims, bounds, inputs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "image/interface_size.h"
#include "image/label_selection.h"
#include "mesh.h"

namespace podm::verify {

struct Options {
  std::string mesh_path;
  std::string image_path;           ///< empty: claims about the image are not run
  LabelSelection selection;         ///< the labels of the image that were meshed
  std::optional<double> smooth_mm;  ///< overrides the width of smoothing that the mesh file states
  std::string schedule_path;        ///< leaf grid and schedule of a PDR or PDR.PODM run; empty: none
  std::vector<std::string> claims;  ///< names asked for; empty: all whose inputs are given
  double radius_edge_bound = 1.93;
  double angle_bound_deg = 30;
  std::optional<double> radius_mm;             ///< circumradius bound r_t of every label not in `radius_of`
  std::map<LabelValue, double> radius_of;      ///< label -> mm
  std::string size_image_path;                 ///< image of local bounds; empty: none
  double size_factor = 1;                      ///< factor of these local bounds
  std::vector<InterfaceSize> interface_sizes;  ///< bounds near interfaces of the image
  std::optional<double> grade;  ///< growth of bounds, mm per mm of distance; none: bounds do not extend
  std::optional<double> min_dihedral_deg, max_dihedral_deg;
  /// Fidelity: 95 % of either surface lies within this many voxels of the other. All of the mesh's surface
  /// lies within sqrt(3) times that distance of the image's.
  double fidelity_bound_voxels = 1;
  /// Surface vertices: the image's label changes within this many voxels of each vertex.
  double vertex_bound_voxels = 1e-5;
  /// The sampling distance of a PODM mesh's surfaces. Distances up to 2 delta are accepted, too
  /// (check_fidelity.cpp, check_labels.cpp, check_surface_vertices.cpp).
  std::optional<double> delta_mm;
  /// The distance at which the mesh samples lines; overrides the one that the mesh file promises. With
  /// either, a weaker bound holds near lines (check_boundary_angles.cpp).
  std::optional<double> lines_delta_mm;
  std::optional<bool> is_box_flat;          ///< overrides what the mesh file promises about the box
  std::optional<Space> space;               ///< overrides the space that the file states
  int threads = 0;                          ///< 0: all cores
  std::string json_path, extract_bad_path;  ///< empty: not written; json_path "-": standard output

  /// Returns the bound on cells of a label, if any.
  std::optional<double> radius_of_label(LabelValue label) const {
    const auto own = radius_of.find(label);
    return own != radius_of.end() ? own->second : radius_mm;
  }
};

}  // namespace podm::verify
