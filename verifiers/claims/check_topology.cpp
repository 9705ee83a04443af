// Claim topology.
//   Statements  First, each component of a label of the image is one component of that label in the mesh, and
//               the other way round; and each part of it that faces join has a centroid of a cell of the
//               label. Second, both have the same number of handles and of cavities. Components, handles and
//               cavities are those of topology_of_image.h and topology_of_mesh.h: faces join voxels, facets
//               join cells, and the image follows the mesh at places that are ambiguous, as the 6-connected
//               and the 26-connected readings of the image differ there. A component of the mesh belongs to
//               the component of the image with its label that most of its cells' centroids are in.
//   Exceptions  A difference that ambiguous places explain is counted, not judged. A piece of the mesh is at
//               an ambiguous place if it is at most two voxels long along each axis, with such a place of its
//               label within half a voxel of its bounds. They explain components that they would join; pieces
//               at them, which are only in the mesh or beside the largest piece of a component; others, up to
//               the number of its parts that faces join; and numbers of handles and cavities that differ by
//               no more than there are ambiguous places at the component. A difference that the file lists
//               ("promise differs split 3 10 20 30": kind, label, voxel) is counted, too, if a difference of
//               this kind and label has the voxel within two voxels of the component's bounds. Each one that
//               is listed excuses one.
//   Rests on    The numbering and signs of adjacency.h. Overlapping cells, or facets of three cells, make the
//               numbers meaningless: structure rejects such meshes.
//   Cost        Linear in voxels and cells, and for each label in the contacts between components. It takes
//               30 bytes per voxel, about 50 per cell.
//   Not proved  That components are where the image has them: fidelity is about that. That a component with
//               many ambiguous places has the right numbers. The background's own components, unless a single
//               label encloses them.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "claims/claims.h"
#include "claims/labels_at_places.h"
#include "claims/tally.h"
#include "claims/topology_of_image.h"
#include "claims/topology_of_mesh.h"
#include "parallel.h"

namespace podm::verify {

namespace {

constexpr const char* kMethod = "union-find and counting";

struct Difference {
  std::string kind;
  LabelValue label = 0;
  std::uint32_t of_image = kNone;
  std::vector<std::uint32_t> of_mesh;
  bool is_ambiguous = false;
  double expected = 0, found = 0;
  std::uint32_t voxel = kNone;  // of a part that is lost
};

class Matching {
 public:
  Matching(const Mesh& mesh, const TopologyOfMesh& of_mesh, const Image& image,
           const TopologyOfImage& of_image, const ImageFrame& frame)
      : mesh_(mesh),
        of_mesh_(of_mesh),
        image_(image),
        of_image_(of_image),
        frame_(frame),
        match_(of_mesh.regions.size(), kNone),
        matching_(of_image.regions.size()),
        meeting_(of_image.regions.size()),
        has_centroid_(image.voxels.size()) {
    match();
  }

  std::vector<Difference> differences() {
    for (std::uint32_t m = 0; m < match_.size(); ++m)
      if (match_[m] == kNone)
        found_.push_back({"spurious", of_mesh_.regions[m].label, kNone, {m}, is_at_ambiguous_place(m), 0, 1});
    std::vector<char> has_more(match_.size());  // regions of the mesh that are all that others have
    for (std::uint32_t r = 0; r < matching_.size(); ++r)
      if (matching_[r].empty())
        for (const std::uint32_t m : meeting_[r]) has_more[m] = 1;
    for (std::uint32_t v = 0; v < of_image_.region_of.size(); ++v) {
      const bool is_part = of_image_.region_of[v] != kNone && of_image_.part_of[v] == v;
      if (!is_part || has_centroid_[v] != 0) continue;
      found_.push_back(
          {"lost", of_image_.regions[of_image_.region_of[v]].label, of_image_.region_of[v], {}, false, 1, 0});
      found_.back().voxel = v;
    }
    for (std::uint32_t r = 0; r < matching_.size(); ++r) compare(r, has_more);
    return std::move(found_);
  }

 private:
  std::uint32_t region_at_centroid(CellId c) {
    Point centroid{};
    for (const VertexId v : mesh_.cells[c])
      for (std::size_t axis = 0; axis < 3; ++axis) centroid[axis] += mesh_.vertices[v][axis] / 4;
    const Point u = frame_.to_voxels(centroid);
    std::size_t number = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const double at = std::floor(u[axis] + 0.5);
      if (!(at >= 0 && at < image_.size[axis])) return kNone;
      number = number * static_cast<std::size_t>(image_.size[axis]) + static_cast<std::size_t>(at);
    }
    const bool is_own = static_cast<LabelValue>(image_.voxels[number]) == mesh_.cell_labels[c];
    if (!is_own) return kNone;
    has_centroid_[of_image_.part_of[number]] = 1;
    return of_image_.region_of[number];
  }

  void match() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> cells;
    for (CellId c = 0; c < mesh_.cells.size(); ++c) {
      if (of_mesh_.region_of[c] == kNone) continue;
      if (const std::uint32_t r = region_at_centroid(c); r != kNone) ++cells[{of_mesh_.region_of[c], r}];
    }
    std::vector<std::uint64_t> most(match_.size(), 0);
    for (const auto& [pair, count] : cells) {
      const auto& [m, r] = pair;
      meeting_[r].push_back(m);
      if (count > most[m]) {
        most[m] = count;
        match_[m] = r;
      }
    }
    for (std::uint32_t m = 0; m < match_.size(); ++m)
      if (match_[m] != kNone) matching_[match_[m]].push_back(m);
  }

  // If several pieces are the largest, one that is at no ambiguous place counts as it.
  bool is_split_ambiguous(std::uint32_t r) const {
    std::size_t largest = 0;
    for (const std::uint32_t m : matching_[r])
      largest = std::max<std::size_t>(largest, of_mesh_.regions[m].size);
    std::uint64_t others = 0, spared = 0;
    for (const std::uint32_t m : matching_[r]) {
      if (is_at_ambiguous_place(m)) continue;
      ++others;
      if (of_mesh_.regions[m].size == largest) spared = 1;
    }
    return others - spared < of_image_.facts[r].parts;
  }

  // True for a small region of the mesh with an ambiguous place of its label near its bounds.
  bool is_at_ambiguous_place(std::uint32_t m) const {
    constexpr double kMostVoxels = 2, kNearVoxels = 0.5, kFar = 1e300;
    Point low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
    for (CellId c = of_mesh_.first[m]; c < mesh_.cells.size(); ++c) {
      if (of_mesh_.region_of[c] != m) continue;
      for (const VertexId v : mesh_.cells[c]) {
        const Point u = frame_.to_voxels(mesh_.vertices[v]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], u[axis]);
          high[axis] = std::max(high[axis], u[axis]);
        }
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (high[axis] - low[axis] > kMostVoxels) return false;
    return std::any_of(of_image_.ambiguous.begin(), of_image_.ambiguous.end(), [&](const auto& place) {
      bool is_near = place.second == of_mesh_.regions[m].label;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = place.first[axis] / 2.0;
        is_near = is_near && at >= low[axis] - kNearVoxels && at <= high[axis] + kNearVoxels;
      }
      return is_near;
    });
  }

  void compare(std::uint32_t r, const std::vector<char>& has_more) {
    const LabelRegion& region = of_image_.regions[r];
    const ImageRegionFacts& facts = of_image_.facts[r];
    const auto& matching = matching_[r];
    if (matching.empty() && !meeting_[r].empty()) {
      const bool is_ambiguous = of_image_.facts[match_[meeting_[r].front()]].group == facts.group;
      found_.push_back({"joined", region.label, r, meeting_[r], is_ambiguous, 1, 0});
    } else if (matching.size() > 1) {
      found_.push_back({"split", region.label, r, matching, is_split_ambiguous(r), 1,
                        static_cast<double>(matching.size())});
    } else if (matching.size() == 1 && has_more[matching[0]] == 0) {
      compare_numbers(r, matching[0]);
    }
  }

  void compare_numbers(std::uint32_t r, std::uint32_t m) {
    const LabelRegion &a = of_image_.regions[r], &b = of_mesh_.regions[m];
    const std::int64_t handles = b.handles() - a.handles(), cavities = b.cavities - a.cavities;
    const bool is_ambiguous =
        static_cast<std::uint64_t>(std::abs(handles) + std::abs(cavities)) <= of_image_.facts[r].ambiguous;
    const auto add = [&](const char* kind, std::int64_t expected, std::int64_t found) {
      found_.push_back(
          {kind, a.label, r, {m}, is_ambiguous, static_cast<double>(expected), static_cast<double>(found)});
    };
    if (handles != 0) add("handles", a.handles(), b.handles());
    if (cavities != 0) add("cavities", a.cavities, b.cavities);
  }

  const Mesh& mesh_;
  const TopologyOfMesh& of_mesh_;
  const Image& image_;
  const TopologyOfImage& of_image_;
  const ImageFrame& frame_;
  std::vector<std::uint32_t> match_;                            // by region of the mesh
  std::vector<std::vector<std::uint32_t>> matching_, meeting_;  // by region of the image
  std::vector<char> has_centroid_;                              // by voxel: of the part that it names
  std::vector<Difference> found_;
};

// The differences that the file lists, and which of them are used up.
class Listed {
 public:
  explicit Listed(const Mesh& mesh) : listed_(mesh.listed_differences), is_used_(listed_.size()) {}

  bool excuses(const Difference& difference, const std::array<int, 3>& low, const std::array<int, 3>& high) {
    constexpr int kSlackVoxels = 2;
    for (std::size_t i = 0; i < listed_.size(); ++i) {
      if (is_used_[i] != 0 || listed_[i].kind != difference.kind || listed_[i].label != difference.label)
        continue;
      bool is_near = true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        is_near = is_near && listed_[i].voxel[axis] >= low[axis] - kSlackVoxels &&
                  listed_[i].voxel[axis] <= high[axis] + kSlackVoxels;
      if (!is_near) continue;
      is_used_[i] = 1;
      return true;
    }
    return false;
  }
  std::uint64_t num_used() const {
    return static_cast<std::uint64_t>(std::count(is_used_.begin(), is_used_.end(), 1));
  }

 private:
  const std::vector<ListedDifference>& listed_;
  std::vector<char> is_used_;
};

class Bounds {
 public:
  Bounds(const Mesh& mesh, const TopologyOfMesh& of_mesh, const TopologyOfImage& of_image,
         const ImageFrame& frame)
      : mesh_(mesh), of_mesh_(of_mesh), of_image_(of_image), frame_(frame) {}

  // Returns those of the component, or of its cells if it is only in the mesh; voxels.
  std::array<std::array<int, 3>, 2> of(const Difference& difference) const {
    if (difference.of_image != kNone)
      return {of_image_.facts[difference.of_image].low, of_image_.facts[difference.of_image].high};
    constexpr int kFar = 1 << 30;
    std::array<std::array<int, 3>, 2> bounds{{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}}};
    for (CellId c = 0; c < mesh_.cells.size(); ++c) {
      if (of_mesh_.region_of[c] != difference.of_mesh.front()) continue;
      for (const VertexId v : mesh_.cells[c]) {
        const Point u = frame_.to_voxels(mesh_.vertices[v]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const int at = static_cast<int>(std::clamp(std::floor(u[axis] + 0.5), -1e9, 1e9));
          bounds[0][axis] = std::min(bounds[0][axis], at);
          bounds[1][axis] = std::max(bounds[1][axis], at);
        }
      }
    }
    return bounds;
  }

 private:
  const Mesh& mesh_;
  const TopologyOfMesh& of_mesh_;
  const TopologyOfImage& of_image_;
  const ImageFrame& frame_;
};

// A voxel of a component of the image, or of its part that is lost.
Point some_voxel(const TopologyOfImage& of_image, const Image& image, const Difference& difference) {
  const auto found = std::find(of_image.region_of.begin(), of_image.region_of.end(), difference.of_image);
  const auto first = static_cast<std::size_t>(found - of_image.region_of.begin());
  const std::size_t at = difference.voxel == kNone ? first : difference.voxel;
  const auto nx = static_cast<std::size_t>(image.size[0]), ny = static_cast<std::size_t>(image.size[1]);
  return {static_cast<double>(at % nx), static_cast<double>(at / nx % ny), static_cast<double>(at / nx / ny)};
}

Witness witness_of(const Difference& difference, const Mesh& mesh, const TopologyOfMesh& of_mesh,
                   const Image& image, const TopologyOfImage& of_image, const ImageFrame& frame) {
  Witness witness;
  witness.statement = fmt::format("components are those of the image: {}, {} instead of {}", difference.kind,
                                  difference.found, difference.expected);
  witness.label = difference.label;
  witness.value = difference.found;
  witness.severity = std::abs(difference.found - difference.expected);
  for (const std::uint32_t m : difference.of_mesh) witness.cells.push_back(of_mesh.first[m]);
  if (difference.of_image != kNone) {
    witness.points = {frame.voxels_to_mesh(some_voxel(of_image, image, difference))};
  } else {
    witness.vertices = global_vertices(mesh, mesh.cells[of_mesh.first[difference.of_mesh.front()]]);
  }
  return witness;
}

}  // namespace

ClaimResult check_topology(const Mesh& mesh, const Adjacency& adjacency, const Image& image) {
  ClaimResult result;
  result.claim = "topology";
  result.method = kMethod;
  if (const char* lack = lack_of_cell_labels(mesh); *lack != 0) {
    result.reason = lack;
    return result;
  }
  const ImageFrame frame(image, mesh.space);
  const TopologyOfMesh of_mesh = find_topology_of_mesh(mesh, adjacency);
  const LabelsAtPlaces label_at(mesh, image, frame, places_to_read(image));
  const TopologyOfImage of_image =
      find_topology_of_image(image, [&](const HalfVoxel& place) { return label_at(place); });
  const std::vector<Difference> differences = Matching(mesh, of_mesh, image, of_image, frame).differences();
  const Bounds bounds(mesh, of_mesh, of_image, frame);
  Listed listed(mesh);
  Tally tally;
  std::uint64_t ambiguous = 0;
  for (const Difference& difference : differences) {
    if (difference.is_ambiguous) {
      ++ambiguous;
      continue;
    }
    const auto [low, high] = bounds.of(difference);
    if (!listed.excuses(difference, low, high))
      tally.violation(witness_of(difference, mesh, of_mesh, image, of_image, frame));
  }
  tally.num_checked = of_image.regions.size();
  result = result_of("topology", tally);
  result.method = kMethod;
  result.num_warnings = listed.num_used();
  result.reason = fmt::format(
      "{} of {} components differ; {} listed in the file; {} more where {} places of the image are ambiguous",
      tally.num_violations, of_image.regions.size(), listed.num_used(), ambiguous, of_image.ambiguous.size());
  result.details() = {{"components_of_image", of_image.regions.size()},
                      {"components_of_mesh", of_mesh.regions.size()},
                      {"ambiguous_places", of_image.ambiguous.size()},
                      {"ambiguous_differences", ambiguous},
                      {"listed_differences", listed.num_used()}};
  return result;
}

}  // namespace podm::verify
