// Abaqus input (.inp) for Abaqus and CalculiX: nodes, one element set of C3D4 per label, one element surface
// per label pair and one per side of a flat box, "box_i-", one node set per line. The surface "liver-kidney"
// consists of sides of liver cells. Numbers of nodes and elements are positions plus one. Format: Abaqus
// Keywords Guide, *NODE, *ELEMENT, *SURFACE.
#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <span>

#include "files/atomic_file.h"
#include "io/facet_sides.h"
#include "io/mesh_formats.h"
#include "io/mesh_sets.h"
#include "io/promises.h"
#include "io/text_file.h"

namespace podm {
namespace {

constexpr std::size_t kLongestName = 80, kLongestReal = 20;  // characters that Abaqus and CalculiX read

// Names of sets: a letter, then letters, digits, '_' and '-'. All names differ even if case is ignored.
class SetNames {
 public:
  const std::string& add(const std::string& wanted, std::int32_t number) {
    std::string name;
    for (const char c : wanted) name += is_letter(c) || is_digit(c) || c == '-' ? c : c == '|' ? '-' : '_';
    if (name.empty() || !is_letter(name[0])) name = "L" + name;
    const std::string ending = fmt::format("-{}", number);
    name.resize(std::min(name.size(), kLongestName - ending.size()));
    while (!taken_.insert(upper(name)).second) name = name.substr(0, kLongestName - ending.size()) + ending;
    return names_.emplace_back(name);
  }
  const std::string& operator[](std::size_t i) const { return names_[i]; }

 private:
  static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  static std::string upper(std::string text) {
    for (char& c : text)
      if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return text;
  }

  std::set<std::string> taken_;
  std::vector<std::string> names_;
};

// A real in the fewest characters that read back to it, or rounded to the digits that fit.
struct RealText {
  std::array<char, 32> characters;
  std::size_t size;
  bool is_rounded = false;

  explicit RealText(double value) {
    size = length(std::to_chars(begin(), end(), value).ptr);
    for (int digits = 16; size > kLongestReal; --digits) {
      size = length(std::to_chars(begin(), end(), value, std::chars_format::general, digits).ptr);
      is_rounded = true;
    }
  }
  std::string_view view() const { return {characters.data(), size}; }

 private:
  char* begin() { return characters.data(); }
  char* end() { return begin() + characters.size(); }
  std::size_t length(const char* after) const { return static_cast<std::size_t>(after - characters.data()); }
};

class AbaqusWriter {
 public:
  AbaqusWriter(const TetMesh& mesh, AtomicFile& file) : mesh_(mesh), text_(file), sets_(mesh) {
    for (const LabelIndex label : sets_.volumes)
      volume_names_.add(sets_.names[label], static_cast<std::int32_t>(mesh.labels[label].value));
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i)
      surface_names_.add(sets_.names.of_pair(sets_.pairs[i]), MeshSets::surface_tag(i));
    for (const std::size_t side : sets_.sides)
      side_names_.push_back(surface_names_.add(name_of_side(side), sets_.side_tag(side)));
    for (std::size_t line = 0; line < sets_.line_names.size(); ++line)
      line_names_.add(sets_.line_names[line], MeshSets::line_tag(line));
  }

  Losses write() {
    print_head();
    warn_of_changed_names();
    print_nodes();
    for (std::size_t i = 0; i < sets_.volumes.size(); ++i) print_elements(i);
    print_surfaces();
    print_lines();
    text_.flush();
    return losses_;
  }

 private:
  // Prints comments that list the labels and pairs, including values that names do not hold.
  void print_head() {
    text_.put("*HEADING\ntetrahedral mesh of labels\n");
    text_.print(FMT_COMPILE("** space {}\n"), to_string(mesh_.space));
    for (const std::string& promise : promises_of(mesh_))
      text_.print(FMT_COMPILE("** promise {}\n"), promise);
    for (std::size_t i = 0; i < sets_.volumes.size(); ++i)
      text_.print(FMT_COMPILE("** label {} elset {} {}\n"), mesh_.labels[sets_.volumes[i]].value,
                  volume_names_[i], sets_.names[sets_.volumes[i]]);
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
      const auto [a, b] = sets_.pairs[i];
      text_.print(FMT_COMPILE("** pair {} {} surface {} {}\n"), mesh_.labels[a].value, mesh_.labels[b].value,
                  surface_names_[i], sets_.names.of_pair(sets_.pairs[i]));
    }
    for (std::size_t line = 0; line < sets_.line_names.size(); ++line)
      text_.print(FMT_COMPILE("** line nset {} {}\n"), line_names_[line], sets_.line_names[line]);
  }

  // Reports changed names. A pair of unchanged names is joined by a dash.
  void warn_of_changed_names() {
    std::size_t labels = 0, surfaces = 0;
    std::string of_label, of_surface;  // the last changed name of each kind
    for (std::size_t i = 0; i < sets_.volumes.size(); ++i) {
      const std::string& name = sets_.names[sets_.volumes[i]];
      if (volume_names_[i] == name) continue;
      ++labels;
      of_label = fmt::format("'{}' is {}", name, volume_names_[i]);
    }
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) {
      std::string name = sets_.names.of_pair(sets_.pairs[i]);
      std::replace(name.begin(), name.end(), '|', '-');
      if (surface_names_[i] == name) continue;
      ++surfaces;
      of_surface = fmt::format("'{}' is {}", name, surface_names_[i]);
    }
    if (labels > 0)
      losses_.push_back(fmt::format("the names of {} labels were changed for sets: {}", labels, of_label));
    if (surfaces > 0)
      losses_.push_back(
          fmt::format("the names of {} pairs of labels were changed for surfaces: {}", surfaces, of_surface));
  }

  void print_nodes() {
    text_.put("*NODE, NSET=Nall\n");
    std::size_t num_rounded = 0;
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
      const auto& [x, y, z] = mesh_.vertices[i];
      const std::array<RealText, 3> reals{RealText(x), RealText(y), RealText(z)};
      for (const RealText& real : reals) num_rounded += real.is_rounded;
      text_.print(FMT_COMPILE("{}, {}, {}, {}\n"), i + 1, reals[0].view(), reals[1].view(), reals[2].view());
    }
    if (num_rounded > 0)
      losses_.push_back(fmt::format("{} coordinates are rounded to {} characters, the format's limit",
                                    num_rounded, kLongestReal));
  }

  void print_elements(std::size_t volume) {
    text_.print(FMT_COMPILE("*ELEMENT, TYPE=C3D4, ELSET={}\n"), volume_names_[volume]);
    for (const std::uint32_t cell : sets_.cells_of_label[sets_.volumes[volume]]) {
      const auto& [a, b, c, d] = mesh_.cells[cell];
      text_.print(FMT_COMPILE("{}, {}, {}, {}, {}\n"), std::size_t{cell} + 1, a + 1, b + 1, c + 1, d + 1);
    }
  }

  void print_surfaces() {
    // S1 has vertices 1 2 3, S2 1 4 2, S3 2 4 3, S4 3 4 1.
    constexpr std::array<int, 4> kSideOpposite{3, 4, 2, 1};
    const std::vector<FacetSide> sides = find_facet_sides(mesh_);
    const auto print = [&](const std::string& name, std::span<const std::uint32_t> facets) {
      text_.print(FMT_COMPILE("*SURFACE, TYPE=ELEMENT, NAME={}\n"), name);
      for (const std::uint32_t facet : facets) {
        const FacetSide& side = sides[facet];
        text_.print(FMT_COMPILE("{}, S{}\n"), std::size_t{side.cell} + 1, kSideOpposite[side.opposite]);
      }
    };
    for (std::size_t i = 0; i < sets_.pairs.size(); ++i) print(surface_names_[i], sets_.facets_of_pair[i]);
    for (std::size_t i = 0; i < sets_.sides.size(); ++i)
      print(side_names_[i], sets_.facets_of_side[sets_.sides[i]]);
  }

  void print_lines() {
    constexpr std::size_t kNumbersPerLine = 16;  // as many as Abaqus reads
    for (std::size_t line = 0; line < sets_.line_names.size(); ++line) {
      text_.print(FMT_COMPILE("*NSET, NSET={}\n"), line_names_[line]);
      const std::vector<std::uint32_t> vertices = vertices_of_line(sets_, mesh_.lines, line);
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        const bool is_last = i + 1 == vertices.size() || (i + 1) % kNumbersPerLine == 0;
        text_.print(FMT_COMPILE("{}{}"), vertices[i] + 1, is_last ? "\n" : ", ");
      }
    }
  }

  const TetMesh& mesh_;
  TextFile text_;
  const MeshSets sets_;
  SetNames volume_names_, surface_names_, line_names_;
  std::vector<std::string> side_names_;  // of sets_.sides
  Losses losses_;
};

}  // namespace

Losses write_abaqus(const TetMesh& mesh, const std::string& path) {
  AtomicFile file(path);
  Losses losses = AbaqusWriter(mesh, file).write();
  file.publish();
  return losses;
}

}  // namespace podm
