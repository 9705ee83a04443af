#include "algorithms/sample_box.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "algorithms/sampler.h"
#include "delaunay/walk.h"
#include "lines/arc.h"

namespace podm {

namespace {

// Both are relative to delta. R1's samples keep delta from the ends of an edge that is at most sqrt(2) delta
// long, and thus are not in its diametral ball.
constexpr double kMostSpacing = 1.4, kLeastSpacing = 0.7;

class BoxSampler : Sampler {
 public:
  BoxSampler(Construction& construction, const Parameters& parameters, const char* phase)
      : Sampler(construction, parameters, phase),
        isosurface_(construction.problem().isosurface),
        parameters_(parameters) {}

  void sample(const LineNetwork& curves) {
    for (const LineNode& node : curves.nodes) insert(node.point, node.sides);
    for (const LineArc& arc : curves.arcs) sample(arc);
  }

 private:
  double delta_at(const Point& p) const {
    return parameters_.deltas != nullptr ? parameters_.deltas->at(p) : parameters_.delta_mm;
  }

  void sample(const LineArc& curve) {
    const Arc arc(curve);
    double position = 0;
    while (position < arc.length() && !is_over()) {
      const double left = arc.length() - position;
      position += left / std::ceil(left / (kMostSpacing * delta_at(arc.point_at(position))));
      insert(arc.point_at(position), curve.sides);
    }
  }

  void insert(const Point& p, SideMask sides) {
    const std::optional<SurfacePoint> z = isosurface_.on_curve_of_box(p, sides);
    if (!z) return;
    last_ = cell_with(mesh_, *z, living_cell(mesh_, last_));
    if (worker_.insert_sample(*z, last_, kLeastSpacing * delta_at(*z))) last_ = worker_.created().front();
  }

  const Isosurface& isosurface_;
  const Parameters& parameters_;
};

}  // namespace

void sample_box(Construction& construction, const Parameters& parameters, const char* phase) try {
  const LineNetwork* curves = construction.problem().box_curves;
  if (curves == nullptr || construction.stop().is_over()) return;
  construction.timed(phase, [&] { BoxSampler(construction, parameters, phase).sample(*curves); });
} catch (const std::bad_alloc&) {
  construction.stop().end(StopReason::kMemoryLimit);
}

}  // namespace podm
