// Functions shared by the writers of a single VTU file and of a mesh in pieces.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "podm/tet_mesh.h"

namespace podm {

/// The name that VTK's own filters give to the array of points' numbers in the whole mesh.
inline constexpr const char* kGlobalIds = "GlobalNodeIds";

/// The name of the array of the facets' sides of a flat box, in files of facets.
inline constexpr const char* kBoxSideArray = "box_side";

/// Returns "x_facets.vtu" for "x.vtu", and likewise for any extension.
std::string facets_path_of(const std::string& path);
/// Returns "x_lines.vtu" for "x.vtu", and likewise for any extension.
std::string lines_path_of(const std::string& path);

/// Writes the files of cells, of facets, and of lines if they were asked for, which have no names until they
/// are published. `vertex_ids`, unless null, has one number per vertex, for the points of the first two.
/// Throws InputError as write_mesh() does.
std::deque<AtomicFile> write_vtu_aside(const TetMesh& mesh, const std::vector<std::uint64_t>* vertex_ids,
                                       const std::string& path);

}  // namespace podm
