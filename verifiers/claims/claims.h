// The claims that podm-verify checks: one check_*.cpp each, whose opening comment states the claim.
#pragma once

#include "claim.h"
#include "geometry/adjacency.h"
#include "image/image.h"
#include "image/size_image.h"
#include "options.h"
#include "ranks/part.h"
#include "schedule.h"

namespace podm::verify {

/// Returns the reason why labels of cells cannot be checked; empty: they can.
inline const char* lack_of_cell_labels(const Mesh& mesh) {
  if (num_cells(mesh) == 0) return "the mesh has no cells";
  return has_cell_labels(mesh) ? "" : "the mesh states no cell labels";
}

// All checks except structure may rely on ids in range and finite coordinates: they are not run on other
// meshes.
ClaimResult check_structure(const Mesh& mesh, const Adjacency& adjacency, const Options& options);
ClaimResult check_delaunay(const Mesh& mesh, const Adjacency& adjacency, const Options& options);
ClaimResult check_radius_edge(const Mesh& mesh, const Adjacency& adjacency, const Options& options);
ClaimResult check_boundary_angles(const Mesh& mesh, const Adjacency& adjacency, const Options& options);
/// `image` null: the claim is not run if bounds near interfaces or a grade are asked for. `sizes` null: there
/// is no size image.
ClaimResult check_size(const Mesh& mesh, const Image* image, const SizeImage* sizes, const Options& options);
ClaimResult check_dihedral(const Mesh& mesh, const Options& options);
/// `schedule` null: checks only the statements that need none, that is, that label interfaces match.
ClaimResult check_conformity(const Mesh& mesh, const Adjacency& adjacency, const Schedule* schedule,
                             const Options& options);
ClaimResult check_labels(const Mesh& mesh, const Image& image, const Options& options);
/// `image` null: components and Euler numbers are reported without the image's beside them.
ClaimResult check_surface(const Mesh& mesh, const Adjacency& adjacency, const Image* image,
                          const Options& options);
ClaimResult check_surface_vertices(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                                   const Options& options);
/// The image must have a flat box. Not on ranks.
ClaimResult check_box(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                      const Options& options);
/// Not on ranks.
ClaimResult check_lines(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                        const Options& options);
ClaimResult check_fidelity(const Mesh& mesh, const Adjacency& adjacency, const Image& image,
                           const Options& options);
/// Not on ranks.
ClaimResult check_topology(const Mesh& mesh, const Adjacency& adjacency, const Image& image);

}  // namespace podm::verify
