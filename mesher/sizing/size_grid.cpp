#include "sizing/size_grid.h"

#include <cmath>
#include <utility>

namespace podm {

NearInterface::NearInterface(ScalarGrid distances_mm, const std::array<double, 3>& spacing_mm,
                             double width_mm, double radius_mm)
    : distances_mm_(std::move(distances_mm)),
      spacing_mm_(spacing_mm),
      width_mm_(width_mm),
      radius_mm_(radius_mm) {}

// p is beyond the width if a node's distance to the interface exceeds the width plus the node's distance from
// p. A point beyond the nodes is replaced by the nearest place between them. No face of the interface is
// farther from that place than from the point: at the image's border the nodes surround all faces, and
// elsewhere the outermost nodes are beyond the width.
bool NearInterface::contains(const Point& p) const {
  constexpr double kRounding = 1e-6;  // of distances in single precision
  auto u = map(distances_mm_.to_nodes(), std::array<double, 3>{p.x, p.y, p.z});
  std::array<int, 3> cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(u[axis])) return false;
    u[axis] = std::clamp(u[axis], 0.0, distances_mm_.size()[axis] - 1.0);
    cell[axis] = std::min(static_cast<int>(u[axis]), distances_mm_.size()[axis] - 2);
  }
  for (unsigned node = 0; node < 8; ++node) {
    std::array<int, 3> at = cell;
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] += static_cast<int>(node >> axis & 1);
      const double along = (u[axis] - at[axis]) * spacing_mm_[axis];
      squared += along * along;
    }
    const double distance = distances_mm_.values()[distances_mm_.index(at[0], at[1], at[2])];
    if (distance * (1 - kRounding) - std::sqrt(squared) > width_mm_) return false;
  }
  return true;
}

SizeGrid::SizeGrid(std::optional<Image> image, std::vector<NearInterface> near,
                   std::optional<ScalarGrid> graded, const Box& object)
    : image_(std::move(image)), near_(std::move(near)), graded_(std::move(graded)) {
  if (image_) least_mm_ = image_->factor * image_->radius_mm.range_in(object).least;
  if (graded_) least_mm_ = std::min(least_mm_, graded_->range_in(object).least);
  for (const NearInterface& each : near_) least_mm_ = std::min(least_mm_, each.radius_mm());
}

}  // namespace podm
