#include "claims/check_surface_listed.h"

#include <algorithm>

#include "ranks/part.h"

namespace podm::verify {

namespace {

// True if b is a rotated.
bool turn_alike(const std::array<VertexId, 3>& a, const std::array<VertexId, 3>& b) {
  const std::size_t shift = a[0] == b[0] ? 0 : a[0] == b[1] ? 1 : 2;
  return a[1] == b[(shift + 1) % 3];
}

class Lister {
 public:
  Lister(const Mesh& mesh, const CellLabelIndices& label_indices, const std::vector<Side>& sides,
         const SidesOfVertex& sides_of)
      : mesh_(mesh),
        label_indices_(label_indices),
        sides_(sides),
        sides_of_(sides_of),
        is_listed_(sides.size(), false) {}

  ListedFacets inspect() {
    for (std::uint32_t f = 0; f < mesh_.facets.size(); ++f) inspect(f);
    for (std::size_t s = 0; s < sides_.size(); ++s)
      if (!is_listed_[s] && is_first_of_facet(s) && owns(sides_[s])) ++result_.missing;
    const std::uint64_t straight = sum_over(ranks_of(mesh_), straight_.size()),
                        reversed = sum_over(ranks_of(mesh_), reversed_.size());
    result_.turned = std::move(straight < reversed ? straight_ : reversed_);
    return std::move(result_);
  }

 private:
  // A facet between two labels has two sides; the side of the greater label represents the facet.
  bool is_first_of_facet(std::size_t s) const { return sides_[s].across < sides_[s].label; }
  // A facet belongs to the rank that owns its least vertex; listed facets are on that rank, too.
  bool owns(const Side& side) const {
    return owns_vertex(mesh_, *std::min_element(side.vertices.begin(), side.vertices.end()));
  }

  void inspect(std::uint32_t f) {
    auto sorted = mesh_.facets[f];
    std::sort(sorted.begin(), sorted.end());
    if (sorted[2] >= mesh_.vertices.size()) return result_.stray.push_back(f);
    const Side *inner = nullptr, *outer = nullptr;  // side of the second label's cell; side of the first's
    bool is_new = false;
    for (const auto* s = sides_of_.begin(sorted[0]); s != sides_of_.end(sorted[0]); ++s) {
      const Side& side = sides_[*s];
      auto vertices = side.vertices;
      std::sort(vertices.begin(), vertices.end());
      if (vertices != sorted) continue;
      is_new = is_new || !is_listed_[*s];
      is_listed_[*s] = true;
      if (has_labels(side, f, 0, 1)) inner = &side;
      if (has_labels(side, f, 1, 0)) outer = &side;
    }
    if (!is_new) return result_.stray.push_back(f);
    if (mesh_.facet_labels.empty()) return;
    if (inner == nullptr && outer == nullptr) return result_.mislabelled.push_back(f);
    const bool is_straight = inner != nullptr ? turn_alike(mesh_.facets[f], inner->vertices)
                                              : !turn_alike(mesh_.facets[f], outer->vertices);
    (is_straight ? straight_ : reversed_).push_back(f);
  }

  bool has_labels(const Side& side, std::uint32_t f, std::size_t across, std::size_t own) const {
    if (mesh_.facet_labels.empty()) return false;
    const auto& stated = mesh_.facet_labels[f];
    return label_indices_.labels[side.label] == stated[own] &&
           label_indices_.labels[side.across] == stated[across];
  }

  const Mesh& mesh_;
  const CellLabelIndices& label_indices_;
  const std::vector<Side>& sides_;
  const SidesOfVertex& sides_of_;
  std::vector<bool> is_listed_;
  std::vector<std::uint32_t> straight_, reversed_;
  ListedFacets result_;
};

}  // namespace

ListedFacets inspect_listed_facets(const Mesh& mesh, const CellLabelIndices& label_indices,
                                   const std::vector<Side>& sides, const SidesOfVertex& sides_of) {
  return Lister(mesh, label_indices, sides, sides_of).inspect();
}

}  // namespace podm::verify
