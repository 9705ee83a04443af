// Anatomy of a tetrahedron: the numbering and sign conventions of the whole project, drawn once.
//
//              v3                     A cell (v0,v1,v2,v3) is positive when
//             /|\                     dot(cross(v1-v0, v2-v0), v3-v0) > 0: seen from v3,
//            / | \                    v0 -> v1 -> v2 turn counter-clockwise.
//           /  |  \                   Facet i is opposite vertex i. Its vertices, in the order of
//         v0---|---v2                 kFacetVertices[i], turn counter-clockwise seen from v_i, so that
//           \  |  /                   (facet, v_i) is again positive; an apex on the *other* side makes a
//            \ | /                    negative cell.
//             \|/                     Facet id = 4 * cell + i; the neighbour across it is stored as the
//              v1                     facet id on the other side, its mirror facet.
#pragma once

#include <array>

namespace podm {

inline constexpr std::array<std::array<int, 3>, 4> kFacetVertices{
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};
inline constexpr std::array<std::array<int, 2>, 6> kEdgeVertices{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// The other two vertices of each edge, in such an order that the edge's vertices followed by them make a
/// positive cell. They are also the indices of the facets that meet at the edge.
inline constexpr std::array<std::array<unsigned, 2>, 6> kOtherVertices{
    {{2, 3}, {3, 1}, {1, 2}, {0, 3}, {2, 0}, {0, 1}}};

}  // namespace podm
