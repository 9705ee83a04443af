#include "claims/check_fidelity_nearest.h"

#include "parallel.h"

namespace podm::verify {

namespace {

double squared_to_box(const Bounds& box, const Point& p) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double d = std::max({box.low[axis] - p[axis], p[axis] - box.high[axis], 0.0});
    sum += d * d;
  }
  return sum;
}

}  // namespace

NearestFacets::NearestFacets(const Mesh& mesh, const InterfaceFacets& facets)
    : ranks_(ranks_of(mesh)), facets_(facets) {
  std::map<LabelValue, std::vector<std::uint32_t>> ids;
  BoxOfLabel own;
  for (std::uint32_t f = 0; f < facets_.all().size(); ++f) {
    Bounds box;
    facets_.bounds(f, box.low, box.high);
    const auto add_to = [&](LabelValue label) {
      ids[label].push_back(f);
      Bounds& all = own.try_emplace(label, kEmptyBounds).first->second;
      all = joined(all, box);
    };
    add_to(kAnyLabel);
    for (const LabelValue label : facets_.all()[f].labels)
      if (label != kAnyLabel) add_to(label);
  }
  for (auto& [label, of_label] : ids) trees_.try_emplace(label, facets_, std::move(of_label));
  boxes_ = gather(ranks_, own);
}

std::vector<NearestFacet> NearestFacets::find_own(const std::vector<FacetQuery>& queries, int threads) const {
  std::vector<NearestFacet> found(queries.size());
  parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    std::uint32_t hint = kNone;
    LabelValue label_of_hint = kAnyLabel;
    for (std::size_t q = begin; q < end; ++q) {
      const FacetQuery& query = queries[q];
      const auto tree = trees_.find(query.label);
      if (tree == trees_.end()) continue;
      Nearest nearest;
      nearest.squared = query.squared;
      if (hint != kNone && label_of_hint == query.label) tree->second.try_shape(hint, query.point, nearest);
      tree->second.improve(query.point, nearest);
      if (nearest.shape == kNone) continue;
      hint = nearest.shape;
      label_of_hint = query.label;
      found[q] = {nearest.point, nearest.squared, facets_.all()[nearest.shape].labels};
    }
  });
  return found;
}

std::vector<NearestFacet> NearestFacets::find(const std::vector<FacetQuery>& queries, int threads) const {
  std::vector<NearestFacet> found = find_own(queries, threads);
  auto asked = lists_for<FacetQuery>(ranks_);
  auto places = lists_for<std::size_t>(ranks_);  // of the queries asked
  for (std::size_t rank = 0; rank < boxes_.size(); ++rank) {
    if (rank == static_cast<std::size_t>(ranks_.rank())) continue;
    for (std::size_t q = 0; q < queries.size(); ++q) {
      const auto box = boxes_[rank].find(queries[q].label);
      if (box == boxes_[rank].end() || squared_to_box(box->second, queries[q].point) >= found[q].squared)
        continue;
      asked[rank].push_back({queries[q].point, queries[q].label, found[q].squared});
      places[rank].push_back(q);
    }
  }
  auto answers = lists_for<NearestFacet>(ranks_);
  asked = exchange(ranks_, std::move(asked));
  for (std::size_t rank = 0; rank < asked.size(); ++rank) answers[rank] = find_own(asked[rank], threads);
  answers = exchange(ranks_, std::move(answers));
  for (std::size_t rank = 0; rank < answers.size(); ++rank)
    for (std::size_t i = 0; i < answers[rank].size(); ++i)
      if (answers[rank][i].squared < found[places[rank][i]].squared)
        found[places[rank][i]] = answers[rank][i];
  return found;
}

bool NearestFacets::is_nearest_rank(const Point& point) const {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t rank = 0; rank < boxes_.size(); ++rank) {
    const auto box = boxes_[rank].find(kAnyLabel);
    if (box == boxes_[rank].end()) continue;
    const double squared = squared_to_box(box->second, point);
    if (squared >= least) continue;
    least = squared;
    nearest = rank;
  }
  return nearest == static_cast<std::size_t>(ranks_.rank());
}

}  // namespace podm::verify
