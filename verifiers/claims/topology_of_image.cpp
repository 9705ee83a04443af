#include "claims/topology_of_image.h"

#include <algorithm>
#include <array>

namespace podm::verify {

namespace {

using Eight = std::array<std::uint32_t, 8>;  // of the voxels at a corner, x fastest

class Grid {
 public:
  explicit Grid(const Image& image) : image_(image) {}

  std::uint32_t num_voxels() const { return static_cast<std::uint32_t>(image_.voxels.size()); }
  /// The number of the voxel, or num_voxels() beyond the grid.
  std::uint32_t at(int i, int j, int k) const {
    const auto& [nx, ny, nz] = image_.size;
    if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz) return num_voxels();
    return static_cast<std::uint32_t>((static_cast<std::int64_t>(k) * ny + j) * nx + i);
  }
  LabelValue label(std::uint32_t voxel) const { return voxel < num_voxels() ? image_.voxels[voxel] : 0; }

  /// Calls visit(corner, numbers of its voxels) for corners at more than one label. The last of the eight has
  /// the corner's own indices.
  template <class Visit>
  void for_each_mixed_corner(const Visit& visit) const {
    std::array<int, 3> c;
    for (c[2] = 0; c[2] <= image_.size[2]; ++c[2])
      for (c[1] = 0; c[1] <= image_.size[1]; ++c[1])
        for (c[0] = 0; c[0] <= image_.size[0]; ++c[0]) {
          Eight eight;
          bool is_mixed = false;
          for (unsigned v = 0; v < 8; ++v) {
            eight[v] = at(c[0] - 1 + static_cast<int>(v & 1), c[1] - 1 + static_cast<int>(v >> 1 & 1),
                          c[2] - 1 + static_cast<int>(v >> 2));
            is_mixed = is_mixed || label(eight[v]) != label(eight[0]);
          }
          if (is_mixed) visit(c, eight);
        }
  }

 private:
  const Image& image_;
};

// The voxels of one label around a corner.
struct Around {
  std::array<bool, 8> has{};

  Around(const Grid& grid, const Eight& eight, LabelValue label) {
    for (unsigned v = 0; v < 8; ++v) has[v] = grid.label(eight[v]) == label;
  }
  /// The first of the label's voxels, of which there must be one.
  unsigned first() const {
    unsigned v = 0;
    while (v < 7 && !has[v]) ++v;
    return v;
  }
  /// The four voxels around the edge that leaves the corner along an axis, down or up, in turn.
  static std::array<unsigned, 4> at_edge(unsigned axis, bool is_up) {
    const unsigned base = is_up ? 1U << axis : 0U, p = 1U << ((axis + 1) % 3), q = 1U << ((axis + 2) % 3);
    return {base, base + p, base + p + q, base + q};
  }
  bool is_ambiguous(unsigned axis, bool is_up) const {
    const auto e = at_edge(axis, is_up);
    return has[e[0]] == has[e[2]] && has[e[1]] == has[e[3]] && has[e[0]] != has[e[1]];
  }
  bool has_ambiguous_edge() const {
    for (unsigned axis = 0; axis < 3; ++axis)
      if (is_ambiguous(axis, false) || is_ambiguous(axis, true)) return true;
    return false;
  }
  /// Joins the voxels of the label, and those of the rest, by faces. joins_label(axis, is_up) decides for
  /// ambiguous edges which of the two they join. Returns the piece of each voxel.
  template <class JoinsLabel>
  std::array<unsigned, 8> pieces(const JoinsLabel& joins_label) const {
    std::array<unsigned, 8> piece{0, 1, 2, 3, 4, 5, 6, 7};
    const auto unite = [&](unsigned v, unsigned w) {
      const unsigned from = std::max(piece[v], piece[w]), to = std::min(piece[v], piece[w]);
      std::replace(piece.begin(), piece.end(), from, to);
    };
    for (unsigned v = 0; v < 8; ++v)
      for (const unsigned bit : {1U, 2U, 4U})
        if (has[v] == has[v ^ bit]) unite(v, v ^ bit);
    for (unsigned axis = 0; axis < 3; ++axis)
      for (const bool is_up : {false, true}) {
        if (!is_ambiguous(axis, is_up)) continue;
        const auto e = at_edge(axis, is_up);
        const unsigned first = has[e[0]] == joins_label(axis, is_up) ? 0 : 1;
        unite(e[first], e[first + 2]);
      }
    return piece;
  }
  int count(const std::array<unsigned, 8>& piece, bool of_label) const {
    int count = 0;
    for (unsigned v = 0; v < 8; ++v) count += has[v] == of_label && piece[v] == v;
    return count;
  }
};

HalfVoxel middle_of_edge(const std::array<int, 3>& corner, unsigned axis, bool is_up) {
  HalfVoxel place{2 * corner[0] - 1, 2 * corner[1] - 1, 2 * corner[2] - 1};
  place[axis] += is_up ? 1 : -1;
  return place;
}
HalfVoxel place_of(const std::array<int, 3>& corner) {
  return {2 * corner[0] - 1, 2 * corner[1] - 1, 2 * corner[2] - 1};
}

// Calls visit(label) for each label of the eight voxels but the background.
template <class Visit>
void for_each_label(const Grid& grid, const Eight& eight, const Visit& visit) {
  for (unsigned v = 0; v < 8; ++v) {
    const LabelValue label = grid.label(eight[v]);
    const bool is_first = std::none_of(eight.begin(), eight.begin() + v,
                                       [&](std::uint32_t w) { return grid.label(w) == label; });
    if (label != 0 && is_first) visit(label);
  }
}

class ImageFinder {
 public:
  ImageFinder(const Image& image, const std::function<LabelValue(const HalfVoxel&)>& label_at)
      : image_(image),
        grid_(image),
        label_at_(label_at),
        parts_(grid_.num_voxels() + 1),
        joined_(grid_.num_voxels() + 1),
        loose_(grid_.num_voxels() + 1) {}

  TopologyOfImage operator()() {
    join_by_faces();
    grid_.for_each_mixed_corner([&](const std::array<int, 3>& corner, const Eight& eight) {
      for_each_label(grid_, eight, [&](LabelValue label) { join_at(corner, eight, label); });
    });
    number_regions();
    count_euler();
    count_cavities();
    return std::move(found_);
  }

 private:
  template <class Visit>
  void for_each_voxel(const Visit& visit) const {
    for (int k = 0; k < image_.size[2]; ++k)
      for (int j = 0; j < image_.size[1]; ++j)
        for (int i = 0; i < image_.size[0]; ++i) visit(i, j, k, grid_.at(i, j, k));
  }

  // Background at the grid's border is one with everything beyond.
  void join_by_faces() {
    for_each_voxel([&](int i, int j, int k, std::uint32_t v) {
      for (const std::uint32_t w : {grid_.at(i - 1, j, k), grid_.at(i, j - 1, k), grid_.at(i, j, k - 1),
                                    grid_.at(i + 1, j, k), grid_.at(i, j + 1, k), grid_.at(i, j, k + 1)})
        if ((w < v || w == grid_.num_voxels()) && grid_.label(w) == grid_.label(v)) {
          parts_.unite(v, w);
          joined_.unite(v, w);
          loose_.unite(v, w);
        }
    });
  }

  bool joins(const std::array<int, 3>& corner, unsigned axis, bool is_up, LabelValue label) const {
    return label_at_(middle_of_edge(corner, axis, is_up)) == label;
  }

  struct Corner {
    std::array<unsigned, 8> piece;
    int of_label, of_rest;
    bool is_in;  // the label goes on through the corner, which several pieces meet at
  };
  Corner look_at(const std::array<int, 3>& corner, const Around& around, LabelValue label) const {
    Corner at;
    at.piece = around.pieces([&](unsigned axis, bool is_up) { return joins(corner, axis, is_up, label); });
    at.of_label = around.count(at.piece, true);
    at.of_rest = around.count(at.piece, false);
    at.is_in = (at.of_label != 1 || at.of_rest != 1) && label_at_(place_of(corner)) == label;
    return at;
  }

  void join_at(const std::array<int, 3>& corner, const Eight& eight, LabelValue label) {
    const Around around(grid_, eight, label);
    const Corner at = look_at(corner, around, label);
    for (unsigned axis = 0; axis < 3; ++axis)
      for (const bool is_up : {false, true}) {
        if (!around.is_ambiguous(axis, is_up)) continue;
        const auto e = Around::at_edge(axis, is_up);
        const unsigned first = around.has[e[0]] ? 0 : 1;
        const std::uint32_t v = eight[e[first]], w = eight[e[first + 2]];
        loose_.unite(v, w);
        if (joins(corner, axis, is_up, label)) joined_.unite(v, w);
        if (is_up) note(v, w, middle_of_edge(corner, axis, is_up), label);
      }
    const std::uint32_t first = eight[around.first()];
    std::uint32_t last = first;
    const bool is_ambiguous = !around.has_ambiguous_edge() && (at.of_label != 1 || at.of_rest != 1);
    for (unsigned v = 0; v < 8; ++v) {
      if (!around.has[v]) continue;
      last = eight[v];
      if (at.is_in) joined_.unite(first, last);
      if (is_ambiguous) loose_.unite(first, last);
    }
    if (is_ambiguous) note(first, last, place_of(corner), label);
  }
  void note(std::uint32_t v, std::uint32_t w, const HalfVoxel& place, LabelValue label) {
    ambiguous_.push_back({v, w});
    found_.ambiguous.emplace_back(place, label);
  }

  void number_regions() {
    found_.region_of.assign(grid_.num_voxels(), kNone);
    std::vector<std::uint32_t> region_of_root(grid_.num_voxels() + 1, kNone);
    for_each_voxel([&](int i, int j, int k, std::uint32_t v) {
      if (grid_.label(v) == 0) return;
      std::uint32_t& region = region_of_root[joined_.root(v)];
      if (region == kNone) {
        region = static_cast<std::uint32_t>(found_.regions.size());
        found_.regions.push_back({.label = grid_.label(v)});
        found_.facts.push_back({.low = {i, j, k}, .high = {i, j, k}});
      }
      found_.region_of[v] = region;
      ++found_.regions[region].size;
      ImageRegionFacts& facts = found_.facts[region];
      facts.parts += parts_.root(v) == v;
      const std::array<int, 3> at{i, j, k};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        facts.low[axis] = std::min(facts.low[axis], at[axis]);
        facts.high[axis] = std::max(facts.high[axis], at[axis]);
      }
    });
    for (std::uint32_t v = 0; v < grid_.num_voxels(); ++v)
      if (found_.region_of[v] != kNone) {
        loose_.unite(v, joined_.root(v));
      }
    for (std::uint32_t v = 0; v < grid_.num_voxels(); ++v)
      if (found_.region_of[v] != kNone) found_.facts[found_.region_of[v]].group = loose_.root(v);
    found_.part_of.resize(grid_.num_voxels());
    for (std::uint32_t v = 0; v < grid_.num_voxels(); ++v) found_.part_of[v] = parts_.root(v);
    for (const auto& [v, w] : ambiguous_) {
      ++found_.facts[found_.region_of[v]].ambiguous;
      if (found_.region_of[w] != found_.region_of[v]) ++found_.facts[found_.region_of[w]].ambiguous;
    }
  }

  // Whole blocks of 1, 2, 4 and 8 voxels of a label that begin at each voxel, with sign; then what ambiguous
  // places add.
  void count_euler() {
    for_each_voxel([&](int i, int j, int k, std::uint32_t v) {
      if (found_.region_of[v] == kNone) return;
      std::int64_t sum = 0;
      for (int block = 0; block < 8; ++block) {
        const int di = block & 1, dj = block >> 1 & 1, dk = block >> 2;
        bool is_whole = true;
        for (int c = 0; c <= dk; ++c)
          for (int b = 0; b <= dj; ++b)
            for (int a = 0; a <= di; ++a)
              is_whole = is_whole && grid_.label(grid_.at(i + a, j + b, k + c)) == grid_.label(v);
        if (is_whole) sum += (di + dj + dk) % 2 == 0 ? 1 : -1;
      }
      found_.regions[found_.region_of[v]].euler += sum;
    });
    grid_.for_each_mixed_corner([&](const std::array<int, 3>& corner, const Eight& eight) {
      for_each_label(grid_, eight, [&](LabelValue label) {
        const Around around(grid_, eight, label);
        if (const Corner at = look_at(corner, around, label); at.is_in)
          found_.regions[found_.region_of[eight[around.first()]]].euler += at.of_rest - at.of_label;
        for (unsigned axis = 0; axis < 3; ++axis) {
          if (!around.is_ambiguous(axis, true) || !joins(corner, axis, true, label)) continue;
          const auto e = Around::at_edge(axis, true);
          --found_.regions[found_.region_of[eight[around.has[e[0]] ? e[0] : e[1]]]].euler;
        }
      });
    });
  }

  void count_cavities() {
    std::vector<std::uint32_t> number(grid_.num_voxels() + 1, kNone), region_of;
    std::vector<LabelValue> labels;
    for (std::uint32_t v = 0; v <= grid_.num_voxels(); ++v)
      if (parts_.root(v) == v) {
        number[v] = static_cast<std::uint32_t>(labels.size());
        labels.push_back(grid_.label(v));
        region_of.push_back(v < grid_.num_voxels() ? found_.region_of[v] : kNone);
      }
    RegionGraph graph(labels);
    const auto part = [&](std::uint32_t v) { return number[parts_.root(v)]; };
    grid_.for_each_mixed_corner(
        [&](const std::array<int, 3>& corner, const Eight& eight) { touch_at(corner, eight, part, graph); });
    graph.count_cavities(region_of, found_.regions);
  }

  // Beside the label of a piece, at most one label goes on through the corner. Its rest is joined there only
  // by faces and edges.
  template <class Part>
  void touch_at(const std::array<int, 3>& corner, const Eight& eight, const Part& part, RegionGraph& graph) {
    LabelValue in = RegionGraph::kAll;
    for_each_label(grid_, eight, [&](LabelValue label) {
      const Around around(grid_, eight, label);
      const Corner at = look_at(corner, around, label);
      if (!at.is_in) return;
      in = label;
      rest_in_pieces(eight, around, at, part, graph);
    });
    for (unsigned v = 0; v < 8; ++v)
      for (unsigned w = 0; w < v; ++w) {
        const std::uint32_t a = part(eight[v]), b = part(eight[w]);
        if (a == b) continue;
        graph.touch(a, b, in);
        const unsigned apart = v ^ w;
        if (apart == 1 || apart == 2 || apart == 4) graph.border(a, b);
      }
  }
  template <class Part>
  void rest_in_pieces(const Eight& eight, const Around& around, const Corner& at, const Part& part,
                      RegionGraph& graph) {
    for (unsigned v = 0; v < 8; ++v)
      for (unsigned w = 0; w < v; ++w) {
        const bool is_one = !around.has[v] && !around.has[w] && at.piece[v] == at.piece[w];
        if (is_one && part(eight[v]) != part(eight[w]))
          graph.touch_for(part(eight[v]), part(eight[w]), grid_.label(eight[around.first()]));
      }
  }

  const Image& image_;
  const Grid grid_;
  const std::function<LabelValue(const HalfVoxel&)>& label_at_;
  NumberSets parts_, joined_, loose_;                    // of voxels, the last one beyond the grid
  std::vector<std::array<std::uint32_t, 2>> ambiguous_;  // two voxels of the label at each place
  TopologyOfImage found_;
};

}  // namespace

std::vector<HalfVoxel> places_to_read(const Image& image) {
  const Grid grid(image);
  std::vector<HalfVoxel> places;
  grid.for_each_mixed_corner([&](const std::array<int, 3>& corner, const Eight& eight) {
    for_each_label(grid, eight, [&](LabelValue label) {
      const Around around(grid, eight, label);
      const auto piece = around.pieces([](unsigned, bool) { return false; });
      const bool is_plain = around.count(piece, true) == 1 && around.count(piece, false) == 1;
      if (!is_plain || around.has_ambiguous_edge()) places.push_back(place_of(corner));
      for (unsigned axis = 0; axis < 3; ++axis)
        for (const bool is_up : {false, true})
          if (around.is_ambiguous(axis, is_up)) places.push_back(middle_of_edge(corner, axis, is_up));
    });
  });
  std::sort(places.begin(), places.end(), [](const HalfVoxel& a, const HalfVoxel& b) {
    return std::array{a[2], a[1], a[0]} < std::array{b[2], b[1], b[0]};
  });
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

TopologyOfImage find_topology_of_image(const Image& image,
                                       const std::function<LabelValue(const HalfVoxel&)>& label_at) {
  return ImageFinder(image, label_at)();
}

}  // namespace podm::verify
