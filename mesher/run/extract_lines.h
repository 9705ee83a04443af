// The edges of lines in the finished mesh, and the report on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "podm/lines_report.h"
#include "podm/mesh_lines.h"
#include "podm/tet_mesh.h"
#include "refine/line_edges.h"

namespace podm {

/// Returns the edges of lines around which all labels of the line meet in the mesh, once each, with vertices
/// by their ids in the store. The labels around an edge name its line. The labels of all cells must be known.
/// `report` gets all but stray edges and the shapes near lines.
MeshLines extract_lines(const Mesh& mesh, const LineEdges& edges, const LabelImage& image,
                        LinesReport& report);

/// Returns the edges along which three or more labels meet and that are not among the mesh's lines.
std::vector<std::array<std::uint32_t, 2>> stray_edges(const TetMesh& mesh);

}  // namespace podm
