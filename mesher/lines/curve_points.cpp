#include "lines/curve_points.h"

#include <optional>

#include "lines/chains.h"
#include "lines/polyline.h"
#include "lines/tie_point.h"

namespace podm {

namespace {

constexpr double kPlaceSpacing = 0.75 * kLatticeSide;  // least distance of places whose points are sought
constexpr double kLongestGap = 4 * kLatticeSide;
constexpr int kMostHalvings = 3;

class CurveFinder {
 public:
  CurveFinder(const WeightForms& forms, const Box& box, const LatticeCurve& curve)
      : forms_(forms), box_(box), curve_(curve) {}

  CurvePoints operator()() {
    find_points();
    if (curve_.is_closed && found_.points.size() < 3) {  // a loop that is lost between lattice points
      found_.points = curve_.places;
      found_.unconfirmed.push_back(curve_.places.front());
    }
    if (curve_.is_closed) found_.points.push_back(found_.points.front());
    remove_reversals(found_.points);
    refine_chords();
    simplify(found_.points, kSimplifyTolerance);
    return std::move(found_);
  }

 private:
  std::optional<Point> point_near(const Point& place) const {
    return tie_point(forms_, curve_.labels, place, box_, kCurveReach);
  }
  void find_points();
  void confirm(const Point& p);
  void refine_chords();
  void add_chord(std::vector<Point>& points, const Point& end, int halvings) const;

  const WeightForms& forms_;
  const Box& box_;
  const LatticeCurve& curve_;
  std::vector<Point> in_gap_;  // places since the last confirmed point
  CurvePoints found_;
};

void CurveFinder::confirm(const Point& p) {
  std::vector<Point>& points = found_.points;
  if (!points.empty() && distance(points.back(), p) > kLongestGap) {
    found_.unconfirmed.push_back(in_gap_.empty() ? points.back() + 0.5 * (p - points.back())
                                                 : in_gap_[in_gap_.size() / 2]);
    points.insert(points.end(), in_gap_.begin(), in_gap_.end());
  }
  in_gap_.clear();
  points.push_back(p);
}

void CurveFinder::find_points() {
  for (const Point& p : curve_.first) confirm(p);
  std::optional<Point> last_sought;
  for (const Point& place : curve_.places) {
    if (last_sought && distance(*last_sought, place) < kPlaceSpacing) continue;
    if (const std::optional<Point> p = point_near(place)) {
      confirm(*p);
      last_sought = place;
    } else {
      in_gap_.push_back(place);
    }
  }
  for (const Point& p : curve_.last) confirm(p);
}

// Appends points from the last one to `end`, more of them where the curve leaves the chord.
void CurveFinder::add_chord(std::vector<Point>& points, const Point& end, int halvings) const {
  const Point begin = points.back(), middle = begin + 0.5 * (end - begin);
  const double chord = distance(begin, end);
  if (halvings < kMostHalvings && chord > kSimplifyTolerance) {
    const std::optional<Point> p = point_near(middle);
    const double off = p ? distance(*p, middle) : 0;
    if (off > kSimplifyTolerance && off < chord) {
      add_chord(points, *p, halvings + 1);
      add_chord(points, end, halvings + 1);
      return;
    }
  }
  points.push_back(end);
}

void CurveFinder::refine_chords() {
  std::vector<Point> points;
  for (const Point& p : found_.points) {
    if (points.empty())
      points.push_back(p);
    else
      add_chord(points, p, 0);
  }
  found_.points = std::move(points);
}

}  // namespace

CurvePoints curve_points(const WeightForms& forms, const Box& box, const LatticeCurve& curve) {
  return CurveFinder(forms, box, curve)();
}

}  // namespace podm
