#include "optimize/cavity_search.h"

#include <algorithm>
#include <bit>

namespace podm {

namespace {

constexpr std::size_t kPoints = CavitySearch::kMaxPoints;
static_assert(kPoints <= 32);  // a set of points is a word
constexpr std::size_t kKeys = kPoints * (kPoints - 1) * (kPoints - 2) / 6;

// The number of sets of three vertices that come before the facet's set, and whether the facet has its
// vertices in the order of their numbers.
struct Key {
  std::size_t key;
  bool is_ascending;
};
Key key_of_facet(LocalFacet f) {
  bool is_ascending = true;
  const auto order = [&](Local& a, Local& b) {
    if (a < b) return;
    std::swap(a, b);
    is_ascending = !is_ascending;
  };
  order(f[0], f[1]);
  order(f[1], f[2]);
  order(f[0], f[1]);
  const std::size_t a = f[0], b = f[1], c = f[2];
  return {a + b * (b - 1) / 2 + c * (c - 1) * (c - 2) / 6, is_ascending};
}

// Returns the three other facets of the cell on `facet`, as seen from inside the cell.
std::array<LocalFacet, 3> sides(const LocalFacet& facet, Local apex) {
  const auto& [a, b, c] = facet;
  return {{{b, apex, c}, {a, c, apex}, {a, apex, b}}};
}
LocalFacet turned(const LocalFacet& f) { return {f[0], f[2], f[1]}; }

// Returns the number of sets of four that come before this one.
std::size_t rank_of(const std::array<Local, 4>& v) {
  const std::size_t a = v[0], b = v[1], c = v[2], d = v[3];
  return a + b * (b - 1) / 2 + c * (c - 1) * (c - 2) / 6 + d * (d - 1) * (d - 2) * (d - 3) / 24;
}

double determinant(const Point& a, const Point& b, const Point& c, const Point& d) {
  return dot(cross(b - a, c - a), d - a);
}

}  // namespace

CavitySearch::CavitySearch(const OptimizationQuality& quality)
    : quality_(quality), known_(kKeys * (kPoints - 3) / 4), opened_(kKeys), apexes_(2 * kKeys) {}

double CavitySearch::six_volumes(const LocalCell& c) const {
  const auto& p = points_;
  return determinant(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
}

void CavitySearch::begin(const LabelBound& bound) {
  bound_ = bound;
  begun_at_ = ++calls_;
}

bool CavitySearch::fill(const std::vector<Point>& points, const std::optional<Point>& added,
                        const std::vector<LocalFacet>& boundary, double floor, unsigned max_steps) {
  points_ = points;
  num_kept_ = points.size();
  if (added) points_.push_back(*added);
  ++calls_;
  floor_ = floor;
  max_steps_ = max_steps;
  num_steps_ = 0;
  for (const LocalFacet& facet : open_) opened_[key_of_facet(facet).key] = 0;
  open_.clear();
  changes_.clear();
  cells_.clear();
  is_on_boundary_.assign(points_.size(), 0);
  volume_ = filled_ = 0;
  for (const LocalFacet& facet : boundary) {
    open(facet);
    for (const Local v : facet) is_on_boundary_[v] = 1;
    volume_ += determinant(points[facet[0]], points[facet[1]], points[facet[2]], points[boundary[0][0]]);
  }
  return fill();
}

bool CavitySearch::fill() {
  if (open_.empty()) return true;
  if (num_steps_ == max_steps_) return false;
  ++num_steps_;
  std::uint32_t apexes = 0;
  int num_fewest = kPoints + 1;
  LocalFacet on{};
  for (const LocalFacet& facet : open_) {
    const std::uint32_t some = apexes_on(facet);
    const int count = std::popcount(some);
    if (count >= num_fewest) continue;
    if (count == 0) return false;
    num_fewest = count;
    apexes = some;
    on = facet;
    if (count == 1) break;
  }
  std::array<Candidate, kMaxPoints> candidates;
  unsigned count = 0;
  for (; apexes != 0; apexes &= apexes - 1) {
    const auto apex = static_cast<Local>(std::countr_zero(apexes));
    candidates[count++] = {quality_on(on, apex), apex};
  }
  std::sort(candidates.begin(), candidates.begin() + count, [](const Candidate& a, const Candidate& b) {
    return a.quality != b.quality ? a.quality > b.quality : a.apex < b.apex;
  });
  for (unsigned i = 0; i < count; ++i) {
    const std::size_t num_changes = changes_.size();
    const double filled = filled_;
    put(on, candidates[i].apex);
    if (filled_ <= volume_ * (1 + 1e-9) && fill()) return true;
    undo(num_changes);
    filled_ = filled;
    cells_.pop_back();
    if (num_steps_ == max_steps_) return false;
  }
  return false;
}

// Returns the apexes of good cells that fit the facets open now.
std::uint32_t CavitySearch::apexes_on(const LocalFacet& facet) {
  std::uint32_t apexes = good_apexes_on(facet);
  for (std::uint32_t left = apexes; left != 0; left &= left - 1) {
    const int apex = std::countr_zero(left);
    if (!fits(facet, static_cast<Local>(apex))) apexes &= ~(std::uint32_t{1} << apex);
  }
  return apexes;
}

std::uint32_t CavitySearch::good_apexes_on(const LocalFacet& facet) {
  const Key key = key_of_facet(facet);
  Apexes& apexes = apexes_[2 * key.key + (key.is_ascending ? 1 : 0)];
  if (apexes.since == calls_) return apexes.set;
  apexes = {calls_, 0};
  for (std::size_t v = 0; v < points_.size(); ++v) {
    const auto apex = static_cast<Local>(v);
    if (apex == facet[0] || apex == facet[1] || apex == facet[2]) continue;
    if (quality_on(facet, apex) > 0) apexes.set |= std::uint32_t{1} << v;
  }
  return apexes.set;
}

// Returns true if the cell is on the right side of each open facet that it has.
bool CavitySearch::fits(const LocalFacet& facet, Local apex) const {
  for (const LocalFacet& side : sides(facet, apex)) {
    const Key key = key_of_facet(side);
    const std::uint16_t opened = opened_[key.key];
    if (opened != 0 && ((opened - 1) % 2 == 1) != key.is_ascending) return false;
  }
  return true;
}

void CavitySearch::put(const LocalFacet& facet, Local apex) {
  cells_.push_back({facet[0], facet[1], facet[2], apex});
  filled_ += six_volumes(cells_.back());
  close(key_of_facet(facet).key);
  for (const LocalFacet& side : sides(facet, apex)) {
    if (const std::size_t key = key_of_facet(side).key; opened_[key] != 0) {
      close(key);
    } else {
      open(turned(side));
      changes_.push_back({turned(side), true});
    }
  }
}

void CavitySearch::open(const LocalFacet& facet) {
  const Key key = key_of_facet(facet);
  opened_[key.key] = static_cast<std::uint16_t>(1 + 2 * open_.size() + (key.is_ascending ? 1 : 0));
  open_.push_back(facet);
}

// Takes the facet off the list, and records that in changes_.
void CavitySearch::close(std::size_t key) {
  const std::size_t place = (opened_[key] - 1u) / 2;
  changes_.push_back({open_[place], false});
  opened_[key] = 0;
  if (place + 1 < open_.size()) {
    open_[place] = open_.back();
    const Key moved = key_of_facet(open_[place]);
    opened_[moved.key] = static_cast<std::uint16_t>(1 + 2 * place + (moved.is_ascending ? 1 : 0));
  }
  open_.pop_back();
}

void CavitySearch::undo(std::size_t num_changes) {
  while (changes_.size() > num_changes) {
    const Change change = changes_.back();
    changes_.pop_back();
    if (change.is_opened) {
      close(key_of_facet(change.facet).key);
      changes_.pop_back();
    } else {
      open(change.facet);
    }
  }
}

float CavitySearch::quality_on(const LocalFacet& facet, Local apex) {
  std::array<Local, 4> v{facet[0], facet[1], facet[2], apex};
  bool is_even = true;
  for (unsigned last = 3; last > 0; --last) {
    for (unsigned i = 0; i < last; ++i) {
      if (v[i] < v[i + 1]) continue;
      std::swap(v[i], v[i + 1]);
      is_even = !is_even;
    }
  }
  Known& known = known_[rank_of(v)];
  const std::uint32_t since = v[3] < num_kept_ ? begun_at_ : calls_;
  if (known.quality_since != since) {
    known.quality_since = since;
    known.quality = find_quality(v);
  }
  const float quality = is_even ? known.quality : -known.quality;
  if (quality <= floor_) return 0;
  if (known.holds_since != calls_) {
    known.holds_since = calls_;
    known.holds_vertex = holds_vertex(v);
  }
  return known.holds_vertex ? 0 : quality;
}

float CavitySearch::find_quality(const std::array<Local, 4>& v) const {
  const auto& p = points_;
  CellPoints cell{p[v[0]], p[v[1]], p[v[2]], p[v[3]]};
  const bool is_positive = determinant(cell.a, cell.b, cell.c, cell.d) > 0;
  if (!is_positive) std::swap(cell.a, cell.b);
  const double quality = quality_.of_new(cell, bound_);
  return static_cast<float>(is_positive ? quality : -quality);
}

// A vertex is inside if it is on the same side of each facet as the cell's own opposite vertex.
bool CavitySearch::holds_vertex(const std::array<Local, 4>& own) const {
  const auto& p = points_;
  const Point &a = p[own[0]], &b = p[own[1]], &c = p[own[2]], &d = p[own[3]];
  const double turn = determinant(a, b, c, d);
  for (std::size_t v = 0; v < p.size(); ++v) {
    if (is_on_boundary_[v] == 0 || std::find(own.begin(), own.end(), v) != own.end()) continue;
    if (turn * determinant(a, b, c, p[v]) > 0 && turn * determinant(b, a, d, p[v]) > 0 &&
        turn * determinant(c, b, d, p[v]) > 0 && turn * determinant(a, c, d, p[v]) > 0)
      return true;
  }
  return false;
}

}  // namespace podm
