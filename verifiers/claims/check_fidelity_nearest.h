// The facet of all ranks' interface facets that is nearest to a point.
#pragma once

#include <map>
#include <vector>

#include "claims/check_fidelity_facets.h"
#include "geometry/box_tree.h"
#include "ranks/part.h"

namespace podm::verify {

inline constexpr LabelValue kAnyLabel = 0;  ///< background has no facets of its own

struct FacetQuery {
  Point point{};                                             ///< world mm
  LabelValue label = kAnyLabel;                              ///< facets with this label on one side
  double squared = std::numeric_limits<double>::infinity();  ///< only nearer facets are asked for
};

struct NearestFacet {
  Point point{};  ///< of the facet
  double squared = std::numeric_limits<double>::infinity();
  std::array<LabelValue, 2> labels{};

  bool has(LabelValue label) const { return labels[0] == label || labels[1] == label; }
};

class NearestFacets {
 public:
  /// Collective. Keeps a reference to the rank's facets.
  NearestFacets(const Mesh& mesh, const InterfaceFacets& facets);

  /// Collective. Returns the nearest facet for each query; infinitely far: no facet has the label. A rank
  /// asks itself first, then the ranks whose facets have a box that is nearer than the facet found.
  std::vector<NearestFacet> find(const std::vector<FacetQuery>& queries, int threads) const;

  /// True on one rank: the first of those with facets in the nearest box.
  bool is_nearest_rank(const Point& point) const;

 private:
  using BoxOfLabel = std::map<LabelValue, Bounds>;

  std::vector<NearestFacet> find_own(const std::vector<FacetQuery>& queries, int threads) const;

  Communication& ranks_;
  const InterfaceFacets& facets_;
  std::map<LabelValue, NearestTree<InterfaceFacets>> trees_;  // by label, and of all facets for kAnyLabel
  std::vector<BoxOfLabel> boxes_;                             // of each rank
};

}  // namespace podm::verify
