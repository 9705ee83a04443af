#include "claims/labels_at_places.h"

#include <algorithm>
#include <cmath>

namespace podm::verify {

namespace {

// Six times the signed volume of the cell (a, b, c, d).
double volume(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]},
      w{d[0] - a[0], d[1] - a[1], d[2] - a[2]};
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

// True for points of the facets, too.
bool contains(const std::array<Point, 4>& p, const Point& at) {
  const double sign = volume(p[0], p[1], p[2], p[3]) < 0 ? -1 : 1;
  return sign * volume(at, p[1], p[2], p[3]) >= 0 && sign * volume(p[0], at, p[2], p[3]) >= 0 &&
         sign * volume(p[0], p[1], at, p[3]) >= 0 && sign * volume(p[0], p[1], p[2], at) >= 0;
}

}  // namespace

LabelsAtPlaces::LabelsAtPlaces(const Mesh& mesh, const Image& image, const ImageFrame& frame,
                               std::vector<HalfVoxel> places)
    : places_(std::move(places)),
      labels_(places_.size(), 0),
      is_known_(places_.size(), 0),
      rows_(2 * image.size[1] + 1),
      slices_(2 * image.size[2] + 1) {
  std::size_t next = 0;
  for (int z = -1; z < slices_ - 1; ++z)
    for (int y = -1; y < rows_ - 1; ++y) {
      first_of_.push_back(next);
      while (next < places_.size() && places_[next][2] == z && places_[next][1] == y) ++next;
    }
  first_of_.push_back(next);
  for (CellId c = 0; c < mesh.cells.size(); ++c) {
    std::array<Point, 4> cell;
    for (std::size_t i = 0; i < 4; ++i) {
      cell[i] = frame.to_voxels(mesh.vertices[mesh.cells[c][i]]);
      for (double& x : cell[i]) x *= 2;
    }
    read(cell, mesh.cell_labels[c]);
  }
}

void LabelsAtPlaces::read(const std::array<Point, 4>& cell, LabelValue label) {
  std::array<int, 3> low, high;
  const std::array<int, 3> most{1 << 30, rows_ - 2, slices_ - 2};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double least = cell[0][axis], greatest = cell[0][axis];
    for (const Point& p : cell) {
      least = std::min(least, p[axis]);
      greatest = std::max(greatest, p[axis]);
    }
    low[axis] = static_cast<int>(std::ceil(std::clamp(least, -1.0, 1e9)));
    high[axis] = std::min(most[axis], static_cast<int>(std::floor(std::clamp(greatest, -2.0, 1e9))));
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (std::size_t i = first_of_[row(y, z)]; i < first_of_[row(y, z) + 1]; ++i) {
        const HalfVoxel& at = places_[i];
        if (at[0] < low[0] || at[0] > high[0] || (is_known_[i] != 0 && labels_[i] <= label)) continue;
        if (!contains(cell,
                      {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])}))
          continue;
        is_known_[i] = 1;
        labels_[i] = label;
      }
}

LabelValue LabelsAtPlaces::operator()(const HalfVoxel& place) const {
  const auto begin = places_.begin() + static_cast<std::ptrdiff_t>(first_of_[row(place[1], place[2])]);
  const auto end = places_.begin() + static_cast<std::ptrdiff_t>(first_of_[row(place[1], place[2]) + 1]);
  const auto found =
      std::lower_bound(begin, end, place[0], [](const HalfVoxel& a, int x) { return a[0] < x; });
  if (found == end || (*found)[0] != place[0]) return 0;
  return labels_[static_cast<std::size_t>(found - places_.begin())];
}

}  // namespace podm::verify
