// The mesh to verify, as its file states it: nothing repaired, nothing reordered, nothing dropped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace podm::verify {

using VertexId = std::uint32_t;  ///< position in Mesh::vertices
using CellId = std::uint32_t;    ///< position in Mesh::cells
using GlobalId = std::uint64_t;  ///< position of a cell, a vertex or a listed facet in the whole mesh
using LabelValue = std::int64_t;
using Point = std::array<double, 3>;

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();  ///< no cell, no vertex

/// The frame of the coordinates according to the file; most foreign formats do not state one.
enum class Space { kUnstated, kRas, kLps, kVoxel };

struct Part;

/// A difference of topology from the image that the file lists.
struct ListedDifference {
  std::string kind;
  LabelValue label = 0;
  std::array<std::int64_t, 3> voxel{};
};

/// A tetrahedral mesh file. Readers guarantee that every vertex id of `cells` and `facets` is the id in the
/// file, made 0-based. An id that names no vertex is kept if it fits, and becomes kNone otherwise. The
/// *structure* claim, not the reader, judges that ids are in range and coordinates are finite.
struct Mesh {
  std::string path;
  std::string format;  ///< for messages: "VTU, appended raw, zlib"
  std::vector<Point> vertices;
  std::vector<std::array<VertexId, 4>> cells;
  std::vector<LabelValue> cell_labels;                  ///< one per cell; empty: the file has none
  std::string cell_label_array;                         ///< its name in the file; empty: none
  std::vector<std::array<VertexId, 3>> facets;          ///< triangles listed by the file; may be empty
  std::vector<std::array<LabelValue, 2>> facet_labels;  ///< one per facet, or empty
  /// One per facet, or empty: its side of a flat box as the file names it, 1 to 6 for i-, i+, j-, j+, k-, k+,
  /// otherwise 0.
  std::vector<std::uint8_t> facet_sides;
  std::map<LabelValue, std::string> label_names;                    ///< as far as the file names them
  std::map<LabelValue, std::array<std::uint8_t, 3>> label_colours;  ///< red, green, blue, of those with one
  std::map<std::string, std::size_t> other_cells;  ///< cells that are neither tetrahedra nor triangles
  Space space = Space::kUnstated;
  std::set<std::string> unclaimed;  ///< claims that the file states not to make
  std::optional<std::array<double, 2>>
      promised_dihedral_deg;  ///< least and largest dihedral angle that the file promises
  /// The number of differences from the topology of the image's labels that the file states to list; none: it
  /// promises nothing about the topology.
  std::optional<std::uint64_t> promised_topology;
  std::vector<ListedDifference> listed_differences;
  std::optional<double> smoothing_mm;             ///< width by which the image was smoothed before meshing
  bool promises_flat_box = false;                 ///< facets at the image's border lie in planes
  std::optional<double> promised_lines_delta_mm;  ///< distance at which lines of three labels are sampled
  /// The part of the mesh that this rank holds (ranks/part.h); null: the whole mesh.
  std::shared_ptr<const Part> part;
};

}  // namespace podm::verify
