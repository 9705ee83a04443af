#include "io/tests/mesh_readers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace podm {
namespace {

void require(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error(what);
}

Space space_of(const std::string& word) {
  for (const Space space : {Space::kRas, Space::kLps, Space::kVoxel})
    if (to_string(space) == word) return space;
  throw std::runtime_error("unknown space " + word);
}

// Reads binary values and text lines one after the other.
class Bytes {
 public:
  explicit Bytes(std::string bytes) : bytes_(std::move(bytes)) {}
  template <class T>
  T take() {
    require(at_ + sizeof(T) <= bytes_.size(), "file ends early");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string line() {
    const std::size_t end = bytes_.find('\n', at_);
    require(end != std::string::npos, "line without an end");
    std::string text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return text;
  }
  void expect_line(const std::string& expected) {
    const std::string found = line();
    require(found == expected, "expected '" + expected + "', found '" + found + "'");
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

std::string rest_of(std::istringstream& words) {
  std::string rest;
  std::getline(words >> std::ws, rest);
  return rest;
}

LabelIndex label_named(const std::string& name, const std::vector<Label>& labels) {
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i].name == name) return static_cast<LabelIndex>(i);
  require(name == "outside", "no label " + name);
  return kBackground;
}

// Reads "liver|kidney|outside".
std::vector<LabelIndex> labels_of_line(const std::string& name, const std::vector<Label>& labels) {
  std::vector<LabelIndex> read;
  std::istringstream parts(name);
  for (std::string part; std::getline(parts, part, '|');) read.push_back(label_named(part, labels));
  require(read.size() >= 3, "a line of fewer than three labels");
  std::sort(read.begin(), read.end());
  return read;
}

class MeditReader {
 public:
  explicit MeditReader(const std::string& path) : file_(path) {
    while (next_line()) {
      if (line_ == "Vertices") read_vertices();
      if (line_ == "Edges") read_edges();
      if (line_ == "Triangles") read_triangles();
      if (line_ == "Tetrahedra") read_tetrahedra();
    }
    require(line_ == "End", "no End");
  }
  TetMesh take() { return std::move(mesh_); }

 private:
  // Reads the next line that is not a comment. Evaluates comments on the way.
  bool next_line() {
    std::string line;
    while (std::getline(file_, line)) {
      if (line[0] != '#') {
        line_ = line;
        return true;
      }
      std::istringstream words(line.substr(1));
      std::string kind, space;
      words >> kind;
      if (kind == "space" && words >> space) mesh_.space = space_of(space);
      if (kind == "label") read_label(words);
      if (kind == "pair") read_pair(words);
      if (kind == "line") read_line(words);
    }
    return false;
  }
  void read_label(std::istringstream& words) {
    if (mesh_.labels.empty()) mesh_.labels.push_back({});
    Label label;
    words >> label.value;
    label.name = rest_of(words);
    index_of_value_[label.value] = static_cast<LabelIndex>(mesh_.labels.size());
    mesh_.labels.push_back(label);
  }
  void read_pair(std::istringstream& words) {
    std::size_t reference;
    std::uint32_t a, b;
    words >> reference >> a >> b;
    require(reference == pairs_.size() + 1, "pairs out of order");
    pairs_.push_back({index_of_value_[a], index_of_value_[b]});  // outside is not in the map: 0
    require(rest_of(words) == mesh_.labels[pairs_.back()[1]].name + "|" +
                                  (pairs_.back()[0] == 0 ? "outside" : mesh_.labels[pairs_.back()[0]].name),
            "wrong pair name");
  }
  void read_line(std::istringstream& words) {
    std::size_t reference;
    words >> reference;
    require(reference == mesh_.lines.labels_of_line.size() + 1, "lines out of order");
    mesh_.lines.labels_of_line.push_back(labels_of_line(rest_of(words), mesh_.labels));
  }
  std::size_t read_count() {
    require(next_line(), "no count");
    return std::stoul(line_);
  }
  std::istringstream item() {
    require(next_line(), "too few items");
    return std::istringstream(line_);
  }
  void read_vertices() {
    for (std::size_t n = read_count(); n > 0; --n) {
      std::istringstream words = item();
      std::array<std::string, 3> text;  // the standard library's stream extraction may round; strtod does not
      words >> text[0] >> text[1] >> text[2];
      mesh_.vertices.push_back({std::stod(text[0]), std::stod(text[1]), std::stod(text[2])});
    }
  }
  void read_edges() {
    for (std::size_t n = read_count(); n > 0; --n) {
      std::istringstream words = item();
      std::uint32_t a, b, reference;
      require(static_cast<bool>(words >> a >> b >> reference), "bad edge");
      mesh_.lines.edges.push_back({a - 1, b - 1});
      mesh_.lines.line_of_edge.push_back(reference - 1);
    }
  }
  void read_triangles() {
    for (std::size_t n = read_count(); n > 0; --n) {
      std::istringstream words = item();
      std::uint32_t a, b, c;
      std::size_t reference;
      require(static_cast<bool>(words >> a >> b >> c >> reference), "bad triangle");
      mesh_.facets.push_back({a - 1, b - 1, c - 1});
      mesh_.facet_labels.push_back(pairs_.at(reference - 1));
    }
  }
  void read_tetrahedra() {
    for (std::size_t n = read_count(); n > 0; --n) {
      std::istringstream words = item();
      std::uint32_t a, b, c, d, value;
      require(static_cast<bool>(words >> a >> b >> c >> d >> value), "bad tetrahedron");
      mesh_.cells.push_back({a - 1, b - 1, c - 1, d - 1});
      mesh_.cell_labels.push_back(index_of_value_.at(value));
    }
  }

  std::ifstream file_;
  std::string line_;
  TetMesh mesh_;
  std::map<std::uint32_t, LabelIndex> index_of_value_;
  std::vector<std::array<LabelIndex, 2>> pairs_;
};

class GmshReader {
 public:
  explicit GmshReader(const std::string& path) : bytes_(read_bytes(path)) {
    bytes_.expect_line("$MeshFormat");
    bytes_.expect_line("4.1 1 8");
    require(bytes_.take<std::int32_t>() == 1, "byte order");
    bytes_.expect_line("");
    bytes_.expect_line("$EndMeshFormat");
    read_comments();
    read_physical_names();
    read_entities();
    read_nodes();
    read_elements();
    require(bytes_.at_end(), "more than expected");
  }
  GmshFile take() { return std::move(result_); }

 private:
  void read_comments() {
    bytes_.expect_line("$Comments");
    result_.mesh.labels.push_back({0, "outside"});
    for (std::string line = bytes_.line(); line != "$EndComments"; line = bytes_.line()) {
      std::istringstream words(line);
      std::string kind, word;
      words >> kind;
      if (kind == "space" && words >> word) result_.mesh.space = space_of(word);
      if (kind != "label") continue;
      Label label;
      std::int32_t tag;
      words >> label.value >> word >> word >> tag;
      label.name = rest_of(words);
      label_of_physical_[tag] = static_cast<LabelIndex>(result_.mesh.labels.size());
      result_.mesh.labels.push_back(label);
    }
  }
  void read_physical_names() {
    bytes_.expect_line("$PhysicalNames");
    for (int n = std::stoi(bytes_.line()); n > 0; --n) {
      std::istringstream words(bytes_.line());
      int dimension, tag;
      words >> dimension >> tag;
      std::string name = rest_of(words);
      require(name.front() == '"' && name.back() == '"', "name without quotes");
      name = name.substr(1, name.size() - 2);
      const std::vector<Label>& labels = result_.mesh.labels;
      if (dimension == 1) {
        auto& lines = result_.mesh.lines.labels_of_line;
        lines.push_back(labels_of_line(name, labels));
        require(tag == static_cast<int>(lines.size()), "lines out of order");
      } else if (dimension == 2) {
        const std::size_t bar = name.find('|');
        pair_of_physical_[tag] = {label_named(name.substr(bar + 1), labels),
                                  label_named(name.substr(0, bar), labels)};
      } else {
        require(label_of_physical_.at(tag) == label_named(name, labels), "a volume's name and tag disagree");
      }
    }
    bytes_.expect_line("$EndPhysicalNames");
  }
  void read_entities() {
    bytes_.expect_line("$Entities");
    require(bytes_.take<std::uint64_t>() == 0, "points");
    const auto num_curves = bytes_.take<std::uint64_t>();
    require(num_curves == result_.mesh.lines.labels_of_line.size(), "curves");
    const auto num_surfaces = bytes_.take<std::uint64_t>(), num_volumes = bytes_.take<std::uint64_t>();
    for (std::uint64_t n = 0; n < num_curves; ++n) {
      const auto [tag, physical] = read_entity_head();
      require(tag == static_cast<int>(n + 1) && physical == tag, "tag of a curve");
      require(bytes_.take<std::uint64_t>() == 0, "points around a curve");
    }
    for (std::uint64_t n = 0; n < num_surfaces; ++n) {
      const auto [tag, physical] = read_entity_head();
      pair_of_entity_[tag] = pair_of_physical_.at(physical);
      require(bytes_.take<std::uint64_t>() == 0, "curves around a surface");
    }
    for (std::uint64_t n = 0; n < num_volumes; ++n) {
      const auto [tag, physical] = read_entity_head();
      const LabelIndex label = label_of_entity_[tag] = label_of_physical_.at(physical);
      for (auto surfaces = bytes_.take<std::uint64_t>(); surfaces > 0; --surfaces) {
        const auto surface = bytes_.take<std::int32_t>();
        auto pair = pair_of_entity_.at(std::abs(surface));
        if (surface < 0) std::swap(pair[0], pair[1]);
        result_.surfaces_of_volume[label].push_back(pair);
      }
    }
    bytes_.expect_line("");
    bytes_.expect_line("$EndEntities");
  }
  std::pair<std::int32_t, std::int32_t> read_entity_head() {
    const auto tag = bytes_.take<std::int32_t>();
    const auto box = bytes_.take<std::array<double, 6>>();
    for (int axis = 0; axis < 3; ++axis) require(box[axis] < box[axis + 3], "empty bounding box");
    require(bytes_.take<std::uint64_t>() == 1, "one physical group expected");
    return {tag, bytes_.take<std::int32_t>()};
  }
  void read_nodes() {
    bytes_.expect_line("$Nodes");
    const auto [num_blocks, num_nodes, min_tag, max_tag] = bytes_.take<std::array<std::uint64_t, 4>>();
    require(min_tag == 1 && max_tag == num_nodes, "node tags");
    result_.mesh.vertices.resize(num_nodes);
    std::vector<int> seen(num_nodes);
    for (std::uint64_t block = 0; block < num_blocks; ++block) {
      const auto [dimension, entity, parametric] = bytes_.take<std::array<std::int32_t, 3>>();
      require(has_entity(dimension, entity), "no such entity");
      require(parametric == 0, "parametric nodes");
      std::vector<std::uint64_t> tags(bytes_.take<std::uint64_t>());
      for (auto& tag : tags) tag = bytes_.take<std::uint64_t>();
      for (const auto tag : tags) {
        result_.mesh.vertices.at(tag - 1) = bytes_.take<std::array<double, 3>>();
        require(seen[tag - 1]++ == 0, "a node twice");
      }
    }
    bytes_.expect_line("");
    bytes_.expect_line("$EndNodes");
  }
  bool has_entity(std::int32_t dimension, std::int32_t entity) const {
    if (dimension == 1)
      return entity >= 1 && static_cast<std::size_t>(entity) <= result_.mesh.lines.labels_of_line.size();
    return dimension == 2 ? pair_of_entity_.contains(entity) : label_of_entity_.contains(entity);
  }
  void read_elements() {
    bytes_.expect_line("$Elements");
    const auto [num_blocks, num_elements, min_tag, max_tag] = bytes_.take<std::array<std::uint64_t, 4>>();
    require(min_tag == 1 && max_tag == num_elements, "element tags");
    std::map<std::uint64_t, std::pair<std::array<std::uint32_t, 3>, std::array<LabelIndex, 2>>> facets;
    std::map<std::uint64_t, std::pair<std::array<std::uint32_t, 4>, LabelIndex>> cells;
    std::map<std::uint64_t, std::pair<std::array<std::uint32_t, 2>, std::uint32_t>> edges;
    for (std::uint64_t block = 0; block < num_blocks; ++block) {
      const auto [dimension, entity, type] = bytes_.take<std::array<std::int32_t, 3>>();
      require((dimension == 1 && type == 1) || (dimension == 2 && type == 2) || (dimension == 3 && type == 4),
              "element type");
      for (auto n = bytes_.take<std::uint64_t>(); n > 0; --n) {
        const auto tag = bytes_.take<std::uint64_t>();
        if (type == 1)
          edges[tag] = {take_vertices<2>(), static_cast<std::uint32_t>(entity - 1)};
        else if (type == 2)
          facets[tag] = {take_vertices<3>(), pair_of_entity_.at(entity)};
        else
          cells[tag] = {take_vertices<4>(), label_of_entity_.at(entity)};
      }
    }
    bytes_.expect_line("");
    bytes_.expect_line("$EndElements");
    require(facets.size() + cells.size() + edges.size() == num_elements, "element count");
    for (const auto& [tag, edge] : edges) {
      result_.mesh.lines.edges.push_back(edge.first);
      result_.mesh.lines.line_of_edge.push_back(edge.second);
    }
    for (const auto& [tag, facet] : facets) {
      result_.mesh.facets.push_back(facet.first);
      result_.mesh.facet_labels.push_back(facet.second);
    }
    for (const auto& [tag, cell] : cells) {
      result_.mesh.cells.push_back(cell.first);
      result_.mesh.cell_labels.push_back(cell.second);
    }
  }
  template <std::size_t N>
  std::array<std::uint32_t, N> take_vertices() {
    std::array<std::uint32_t, N> vertices;
    for (auto& vertex : vertices) vertex = static_cast<std::uint32_t>(bytes_.take<std::uint64_t>() - 1);
    return vertices;
  }

  Bytes bytes_;
  GmshFile result_;
  std::map<std::int32_t, LabelIndex> label_of_physical_, label_of_entity_;
  std::map<std::int32_t, std::array<LabelIndex, 2>> pair_of_physical_, pair_of_entity_;
};

}  // namespace

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  require(file.is_open(), "no file " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TetMesh read_medit(const std::string& path) { return MeditReader(path).take(); }

GmshFile read_gmsh(const std::string& path) { return GmshReader(path).take(); }

Triangles read_stl(const std::string& path) {
  Bytes bytes(read_bytes(path));
  bytes.take<std::array<char, 80>>();
  Triangles triangles(bytes.take<std::uint32_t>());
  for (auto& triangle : triangles) {
    bytes.take<std::array<float, 3>>();
    for (auto& point : triangle)
      for (double& coordinate : point) coordinate = bytes.take<float>();
    require(bytes.take<std::uint16_t>() == 0, "attribute");
  }
  require(bytes.at_end(), "more than expected");
  return triangles;
}

Triangles read_ply(const std::string& path) {
  Bytes bytes(read_bytes(path));
  bytes.expect_line("ply");
  bytes.expect_line("format binary_little_endian 1.0");
  std::size_t num_vertices = 0, num_faces = 0;
  for (std::string line = bytes.line(); line != "end_header"; line = bytes.line()) {
    if (line.starts_with("element vertex ")) num_vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) num_faces = std::stoul(line.substr(13));
  }
  std::vector<std::array<double, 3>> vertices(num_vertices);
  for (auto& vertex : vertices) vertex = bytes.take<std::array<double, 3>>();
  Triangles triangles(num_faces);
  for (auto& triangle : triangles) {
    require(bytes.take<std::uint8_t>() == 3, "not a triangle");
    for (auto& point : triangle) point = vertices.at(bytes.take<std::uint32_t>());
  }
  require(bytes.at_end(), "more than expected");
  return triangles;
}

}  // namespace podm
