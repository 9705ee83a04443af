#include "isosurface/brick_distances.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr double square(double x) { return x * x; }

// One line of bricks. Its parabolas are cost + (side * (i - position))^2.
class Line {
 public:
  explicit Line(std::size_t most) : sites_(most) {}

  /// Replaces the costs of a line of `length` bricks, `stride` apart, by the lower envelope of their
  /// parabolas.
  void transform(std::uint64_t* first, std::size_t length, std::size_t stride, double side) {
    squared_side_ = square(side);
    count_ = 0;
    for (std::size_t i = 0; i < length; ++i) {
      const auto cost = std::bit_cast<double>(first[i * stride]);
      if (cost != std::numeric_limits<double>::infinity()) add({static_cast<double>(i), cost});
    }
    if (count_ == 0) return;
    for (std::size_t i = 0, s = 0; i < length; ++i) {
      while (s + 1 < count_ && height(sites_[s + 1], i) < height(sites_[s], i)) ++s;
      first[i * stride] = std::bit_cast<std::uint64_t>(height(sites_[s], i));
    }
  }

 private:
  struct Site {
    double position, cost;
  };

  void add(const Site& site) {
    while (count_ >= 2 && is_hidden(sites_[count_ - 2], sites_[count_ - 1], site)) --count_;
    sites_[count_++] = site;
  }
  double height(const Site& s, std::size_t i) const {
    return s.cost + squared_side_ * square(static_cast<double>(i) - s.position);
  }
  // True if b, which lies between a and c, is nowhere lower than both of them.
  bool is_hidden(const Site& a, const Site& b, const Site& c) const {
    const double ab = b.position - a.position, bc = c.position - b.position, ac = ab + bc;
    return ac * b.cost - bc * a.cost - ab * c.cost > ab * bc * ac * squared_side_;
  }

  std::vector<Site> sites_;
  std::size_t count_ = 0;
  double squared_side_ = 0;
};

}  // namespace

void find_squared_distances(const BrickGrid& bricks, const std::array<double, 3>& side, std::size_t threads,
                            std::span<std::uint64_t> squared) {
  const auto nx = static_cast<std::size_t>(bricks.size()[0]), ny = static_cast<std::size_t>(bricks.size()[1]),
             nz = static_cast<std::size_t>(bricks.size()[2]);
  std::vector<Line> lines(threads, Line(std::max({nx, ny, nz})));
  parallel_for(nz, threads, [&](std::size_t k, std::size_t thread) {
    std::uint64_t* const slice = &squared[k * nx * ny];
    for (std::size_t j = 0; j < ny; ++j) lines[thread].transform(slice + j * nx, nx, 1, side[0]);
    for (std::size_t i = 0; i < nx; ++i) lines[thread].transform(slice + i, ny, nx, side[1]);
  });
  parallel_for(ny, threads, [&](std::size_t j, std::size_t thread) {
    for (std::size_t i = 0; i < nx; ++i) lines[thread].transform(&squared[j * nx + i], nz, nx * ny, side[2]);
  });
}

}  // namespace podm
