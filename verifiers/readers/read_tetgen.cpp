// TetGen's .node, .ele and .face: a line of counts, then one line per item, with ids from 0 or from 1 as in
// .node. podm's comments give the space, the labels' names and the pair of labels for each marker of a face.
#include <fmt/format.h>

#include <array>

#include "readers/cursor.h"
#include "readers/formats.h"
#include "readers/mesh_parts.h"

namespace podm::verify {
namespace {

class TetgenReader {
 public:
  Mesh read(const MeshFile& nodes, const MeshFile& elements, const MeshFile* faces) {
    read_nodes(nodes);
    read_elements(elements);
    if (faces != nullptr) read_faces(*faces);
    mesh_.format = fmt::format("TetGen, {}-based", base_);
    return std::move(mesh_);
  }

 private:
  Cursor open(const MeshFile& file) {
    Cursor cursor(file);
    cursor.skip_comments(
        [this, &file](std::string_view text) { read_comment(file, text, mesh_, group_of_marker_); });
    return cursor;
  }

  // Reads a number of the head line that may be left out.
  static std::size_t optional_count(Cursor& cursor, const char* what, std::size_t otherwise) {
    return cursor.is_at_end_of_line() ? otherwise : cursor.count(what, 1);
  }

  static void check_number(const Cursor& cursor, std::int64_t number, std::int64_t expected) {
    if (number != expected) cursor.refuse(fmt::format("number {} where {} is expected", number, expected));
  }

  void read_nodes(const MeshFile& file) {
    Cursor cursor = open(file);
    const std::size_t count = cursor.count("the number of nodes", 8);
    if (optional_count(cursor, "the dimension", 3) != 3) cursor.refuse("the dimension is not 3");
    cursor.rest_of_line();  // attributes and markers are ignored
    check_counts(file, "line 1", count, 0);
    make_room(mesh_.vertices, count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = cursor.number<std::int64_t>("the number of a node");
      if (i == 0) base_ = number == 0 ? 0 : 1;
      check_number(cursor, number, base_ + static_cast<std::int64_t>(i));
      Point point;
      for (double& coordinate : point) coordinate = cursor.number<double>("a coordinate");
      mesh_.vertices.push_back(point);
      cursor.rest_of_line();
    }
  }

  template <std::size_t N>
  std::array<VertexId, N> read_ids(Cursor& cursor) const {
    std::array<VertexId, N> ids;
    for (VertexId& id : ids) {
      const auto number = cursor.number<std::int64_t>("the number of a node");
      id = number < base_ ? kNone : vertex_id(number - base_);
    }
    return ids;
  }

  void read_elements(const MeshFile& file) {
    Cursor cursor = open(file);
    const std::size_t count = cursor.count("the number of tetrahedra", 10);
    const std::size_t num_nodes = optional_count(cursor, "nodes per tetrahedron", 4);
    if (num_nodes != 4 && num_nodes != 10)
      cursor.refuse(fmt::format("{} nodes per tetrahedron, neither 4 nor 10", num_nodes));
    bool has_labels = optional_count(cursor, "attributes per tetrahedron", 0) > 0;
    cursor.rest_of_line();
    check_counts(file, "line 1", 0, count);
    make_room(mesh_.cells, count);
    for (std::size_t i = 0; i < count; ++i) {
      check_number(cursor, cursor.number<std::int64_t>("the number of a tetrahedron"),
                   base_ + static_cast<std::int64_t>(i));
      mesh_.cells.push_back(read_ids<4>(cursor));
      if (num_nodes == 10) read_ids<6>(cursor);
      if (has_labels) {
        const auto label = exact_integer(cursor.number<double>("the attribute of a tetrahedron"));
        has_labels = label.has_value();  // an attribute that is no integer is no label
        if (label) mesh_.cell_labels.push_back(*label);
      }
      cursor.rest_of_line();
    }
    cursor.is_at_last_word();  // reads the comments at the end
    if (!has_labels) mesh_.cell_labels.clear();
    if (has_labels && count > 0) mesh_.cell_label_array = "attribute of .ele";
    if (num_nodes == 10 && count > 0) mesh_.other_cells[kQuadraticTetrahedra] = count;
  }

  void read_faces(const MeshFile& file) {
    Cursor cursor = open(file);
    const std::size_t count = cursor.count("the number of faces", 8);
    const bool has_markers = optional_count(cursor, "markers per face", 0) > 0;
    cursor.rest_of_line();
    std::vector<std::int64_t> markers;
    make_room(mesh_.facets, count);
    for (std::size_t i = 0; i < count; ++i) {
      check_number(cursor, cursor.number<std::int64_t>("the number of a face"),
                   base_ + static_cast<std::int64_t>(i));
      mesh_.facets.push_back(read_ids<3>(cursor));
      if (has_markers) markers.push_back(cursor.number<std::int64_t>("the marker of a face"));
      cursor.rest_of_line();
    }
    cursor.is_at_last_word();  // reads the comments at the end
    if (!group_of_marker_.empty()) label_facets(file, "a face", "marker", markers, group_of_marker_, mesh_);
  }

  Mesh mesh_;
  std::int64_t base_ = 1;
  FacetGroups group_of_marker_;
};

}  // namespace

Mesh read_tetgen(const MeshFile& nodes, const MeshFile& elements, const MeshFile* faces) {
  return TetgenReader().read(nodes, elements, faces);
}

}  // namespace podm::verify
