// The mesh under test, as its file states it: nothing repaired, nothing reordered, nothing dropped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace podm::verify {

using VertexId = std::uint32_t;  ///< position in Mesh::vertices
using CellId = std::uint32_t;    ///< position in Mesh::cells
using LabelValue = std::int64_t;
using Point = std::array<double, 3>;

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();  ///< no cell, no vertex

/// The frame that the file says its coordinates are in; most foreign formats say nothing.
enum class Space { kUnstated, kRas, kLps, kVoxel };

/// A tetrahedral mesh file. Readers guarantee that every vertex id of `cells` and `facets` is the id the file
/// gives, made 0-based; an id that names no vertex is left as it is when it fits, and kNone otherwise:
/// whether ids are in range and coordinates finite is the *structure* claim's to judge, not the reader's.
struct Mesh {
  std::string path;
  std::string format;  ///< for people: "VTU, appended raw, zlib"
  std::vector<Point> vertices;
  std::vector<std::array<VertexId, 4>> cells;
  std::vector<LabelValue> cell_labels;                  ///< one a cell; empty: the file has none
  std::string cell_label_array;                         ///< the name it has in the file; empty: none
  std::vector<std::array<VertexId, 3>> facets;          ///< triangles listed by the file; may be empty
  std::vector<std::array<LabelValue, 2>> facet_labels;  ///< one a facet, or empty
  std::map<LabelValue, std::string> label_names;        ///< as far as the file names them
  std::map<std::string, std::size_t> other_cells;       ///< cells that are neither tetrahedra nor triangles
  Space space = Space::kUnstated;
  std::set<std::string> unclaimed;  ///< claims that its maker does not make
  std::optional<std::array<double, 2>>
      promised_dihedral_deg;           ///< least and largest dihedral angle, as promised
  std::optional<double> smoothing_mm;  ///< the width that the image was smoothed by before it was meshed
};

}  // namespace podm::verify
