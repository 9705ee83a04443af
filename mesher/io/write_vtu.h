// What the writers of one VTU file and of a mesh in pieces share.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "podm/tet_mesh.h"

namespace podm {

/// The array of points' numbers in the whole mesh, by the name that VTK's own filters give it.
inline constexpr const char* kGlobalIds = "GlobalNodeIds";

/// "x_facets.vtu" for "x.vtu", and so for any extension.
std::string facets_path_of(const std::string& path);

/// The files of cells and of facets, which have no names until they are published. `vertex_ids`, unless null,
/// has a number a vertex, for the points of both. Throws InputError as write_mesh() does.
std::deque<AtomicFile> write_vtu_aside(const TetMesh& mesh, const std::vector<std::uint64_t>* vertex_ids,
                                       const std::string& path);

}  // namespace podm
