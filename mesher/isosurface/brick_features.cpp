#include "isosurface/brick_features.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "isosurface/isosurface_block.h"

namespace podm {

namespace {

// The window has kWindow voxels along an axis if it spans two bricks on each side. The brick's four begin at
// kFirst.
constexpr int kWindow = 20, kFirst = 8, kMostOffset = 11;

// Rows or slices of the window from the brick outwards, and the distance of each from the brick.
struct Outward {
  int at, gap;
};
constexpr auto kOutward = [] {
  std::array<Outward, kWindow> outward{};
  for (int n = 0; n < kWindow; ++n) {
    const int gap = n < 4 ? 0 : (n - 2) / 2;
    outward[static_cast<std::size_t>(n)] = {n < 4        ? kFirst + n
                                            : n % 2 == 0 ? kFirst - gap
                                                         : kFirst + 3 + gap,
                                            gap};
  }
  return outward;
}();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double square(double x) { return x * x; }

// One value per voxel for four adjacent voxels along x.
using Ints [[gnu::vector_size(16)]] = std::int32_t;
using Longs [[gnu::vector_size(32)]] = std::int64_t;
using Doubles [[gnu::vector_size(32)]] = double;

// The offset d of a voxel along a row, as a number that grows with the distance: 2|d|, and 1 more upwards.
// The least number is that of the nearest voxel, and of the lower one if two are equally near.
constexpr int kBelow = 0, kAbove = 1;

// The least numbers of offsets from the brick's four voxels of a row to those of the four that the bits mark.
constexpr auto kWithinBrick = [] {
  std::array<Ints, 16> least{};
  for (unsigned bits = 0; bits < 16; ++bits) {
    std::array<int, 4> numbers{};
    for (int x = 0; x < 4; ++x) {
      int& number = numbers[static_cast<std::size_t>(x)] = 2 * kWindow;
      for (int to = 0; to < 4; ++to)
        if ((bits >> to & 1) != 0)
          number = std::min(number, to > x ? 2 * (to - x) + kAbove : 2 * (x - to) + kBelow);
    }
    least[bits] = Ints{numbers[0], numbers[1], numbers[2], numbers[3]};
  }
  return least;
}();

// The numbers of the offsets from the brick's four voxels to the nearest in a row of the window, one bit per
// voxel. The row must not be empty.
Ints nearest_in_row(std::uint32_t row) {
  const int gap_below = std::countl_zero(row << (32 - kFirst)),
            gap_above = std::countr_zero(row >> (kFirst + 4));
  const Ints below = 2 * gap_below + kBelow + Ints{2, 4, 6, 8},
             above = 2 * gap_above + kAbove + Ints{8, 6, 4, 2};
  const Ints outside = below < above ? below : above, within = kWithinBrick[row >> kFirst & 15];
  return within < outside ? within : outside;
}

// Four adjacent voxels along x: the least squared distance found yet, and the bits of its offset.
struct Four {
  Doubles squared = Doubles{} + kInfinity;
  Longs bits{};

  void take_if_nearer(const Four& from, double squared_along, std::int64_t bits_along) {
    const Doubles s = from.squared + squared_along;
    const Longs is_nearer = s < squared;
    bits = is_nearer ? from.bits + bits_along : bits;
    squared = is_nearer ? s : squared;
  }
};

// The nearest in a row whose voxels are `spacing` mm long. The row must not be empty.
Four four_in_row(std::uint32_t row, double spacing) {
  const Ints numbers = nearest_in_row(row), distance = numbers >> 1, below = (numbers & 1) - 1;
  const Doubles along = spacing * __builtin_convertvector(distance, Doubles);
  return {along * along, __builtin_convertvector((distance ^ below) - below, Longs)};
}

double greatest(const std::array<Four, 16>& rows) {
  Doubles most{};
  for (const Four& four : rows) most = four.squared > most ? four.squared : most;
  return std::max({most[0], most[1], most[2], most[3]});
}

constexpr std::int64_t kBitsAlongY = 1 << 5, kBitsAlongZ = 1 << 10;

}  // namespace

Surroundings::Surroundings(const LabelImage& image) : reach_mm_(kInfinity) {
  const double shortest = std::min({image.spacing[0], image.spacing[1], image.spacing[2]});
  for (std::size_t a = 0; a < 3; ++a) {
    num_bricks_[a] = 5 * image.spacing[a] < 8 * shortest ? kMostBricks : 1;
    // The first voxel beyond the searched bricks is this far from the last voxel of the brick.
    reach_mm_ = std::min(reach_mm_, (4 * num_bricks_[a] + 1) * image.spacing[a]);
  }
}

// The masks of the bricks around one brick, at most 5^3.
struct BrickFeatures::Window {
  Window(const BrickFeatures& of, const Voxel& brick) : num_bricks(of.surroundings_.num_bricks()) {
    const auto& [x, y, z] = num_bricks;
    for (int k = -z; k <= z; ++k)
      for (int j = -y; j <= y; ++j)
        for (int i = -x; i <= x; ++i) {
          const Voxel b{brick.i + i, brick.j + j, brick.k + k};
          if (!of.bricks_.contains(b.i, b.j, b.k)) continue;
          const std::uint64_t m = of.masks_[of.bricks_.index(b.i, b.j, b.k)];
          mask[index(j + 2, k + 2) + static_cast<std::size_t>(i + 2)] = m;
          any[static_cast<std::size_t>(k + 2)][static_cast<std::size_t>(j + 2)] |= m;
        }
  }
  static std::size_t index(int j, int k) { return static_cast<std::size_t>(25 * k + 5 * j); }
  /// The surface voxels of a row, one bit per voxel.
  std::uint32_t row(int y, int z) const {
    const unsigned shift = place_in_brick({0, y, z});
    if ((any[static_cast<std::size_t>(z / 4)][static_cast<std::size_t>(y / 4)] >> shift & 15) == 0) return 0;
    const std::uint64_t* const five = &mask[index(y / 4, z / 4)];
    std::uint32_t row = 0;
    for (unsigned i = 0; i < 5; ++i) row |= static_cast<std::uint32_t>(five[i] >> shift & 15) << (4 * i);
    return row;
  }
  bool has_surface(int z) const {
    std::uint64_t of_all = 0;
    for (const std::uint64_t m : any[static_cast<std::size_t>(z / 4)]) of_all |= m;
    return (of_all >> place_in_brick({0, 0, z}) & 0xffff) != 0;
  }

  std::array<int, 3> num_bricks;
  std::array<std::uint64_t, 125> mask{};
  std::array<std::array<std::uint64_t, 5>, 5> any{};  // by k, then j: the union over all i
};

BrickFeatures::BrickFeatures(const LabelImage& image, const BrickGrid& bricks, const SurfaceMasks& masks,
                             const Surroundings& surroundings)
    : bricks_(bricks), masks_(masks), surroundings_(surroundings), spacing_(image.spacing) {
  for (int d = -kMostOffset; d <= kMostOffset; ++d) {
    squared_y_[static_cast<std::size_t>(d + kMostOffset)] = square(spacing_[1] * d);
    squared_z_[static_cast<std::size_t>(d + kMostOffset)] = square(spacing_[2] * d);
  }
}

// Distances along the axes add up. The least sums are therefore found one axis after another: the nearest
// voxel of a slice is the nearest of one of its rows, and the nearest voxel of all is the nearest of one of
// the slices. Rows and slices farther than all features found yet, or than the reach, are skipped.
std::array<FeatureOffset, 64> BrickFeatures::offsets(const Voxel& brick) const {
  const Window window(*this, brick);
  const auto at = [](const auto& squared, int offset) {
    return squared[static_cast<std::size_t>(offset + kMostOffset)];
  };
  const double squared_reach = square(surroundings_.reach_mm());
  double farthest2 = squared_reach;
  std::array<Four, 16> nearest;  // rows of the brick
  for (const auto& [z, gap_z] : kOutward) {
    if (at(squared_z_, gap_z) >= farthest2) break;
    if (!window.has_surface(z)) continue;
    std::array<Four, 4> in_slice;
    for (const auto& [y, gap_y] : kOutward) {
      if (at(squared_y_, gap_y) + at(squared_z_, gap_z) >= farthest2) break;
      const std::uint32_t row = window.row(y, z);
      if (row == 0) continue;
      const Four in_row = four_in_row(row, spacing_[0]);
      for (int to = 0; to < 4; ++to) {
        const int along = y - kFirst - to;
        in_slice[static_cast<std::size_t>(to)].take_if_nearer(in_row, at(squared_y_, along),
                                                              along * kBitsAlongY);
      }
    }
    for (int to = 0; to < 4; ++to) {
      const int along = z - kFirst - to;
      for (std::size_t y = 0; y < 4; ++y)
        nearest[static_cast<std::size_t>(4 * to) + y].take_if_nearer(in_slice[y], at(squared_z_, along),
                                                                     along * kBitsAlongZ);
    }
    farthest2 = std::min(squared_reach, greatest(nearest));
  }
  std::array<FeatureOffset, 64> offsets;
  for (std::size_t p = 0; p < 64; ++p) {
    const Four& four = nearest[p / 4];
    if (four.squared[p % 4] < squared_reach)
      offsets[p] =
          FeatureOffset(static_cast<std::uint16_t>(four.bits[p % 4] + FeatureOffset(0, 0, 0).bits()));
  }
  return offsets;
}

BrickNeighborhoods::BrickNeighborhoods(const LabelImage& image, const Voxel& brick) {
  const int x = 4 * brick.i - 1, y = 4 * brick.j - 1, z = 4 * brick.k - 1;
  labels_.fill(kBackground);
  if (image.is_box_flat) {
    read_clamped(image, {x, y, z});
    return;
  }
  const int begin = std::max(0, -x), end = std::min(6, image.size[0] - x);
  for (int k = std::max(0, -z); k < std::min(6, image.size[2] - z); ++k)
    for (int j = std::max(0, -y); j < std::min(6, image.size[1] - y); ++j)
      std::copy_n(&image.voxels[image.index(x + begin, y + j, z + k)], end - begin,
                  &labels_[static_cast<std::size_t>(6 * k + j) * kRow + static_cast<std::size_t>(begin)]);
}

void BrickNeighborhoods::read_clamped(const LabelImage& image, const Voxel& first) {
  const auto inside = [&](int at, std::size_t axis) { return std::clamp(at, 0, image.size[axis] - 1); };
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i)
        labels_[static_cast<std::size_t>(6 * k + j) * kRow + static_cast<std::size_t>(i)] =
            image.voxels[image.index(inside(first.i + i, 0), inside(first.j + j, 1), inside(first.k + k, 2))];
}

Neighborhood BrickNeighborhoods::around(unsigned place) const {
  const std::size_t first = first_around(place);
  const auto differing_from = [&](LabelIndex label) {
    std::uint32_t bits = 0;
    for (std::size_t r = 0; r < 9; ++r) {
      std::uint64_t four;
      std::memcpy(&four, &labels_[first + (6 * (r / 3) + r % 3) * kRow], sizeof four);
      bits |= (differing(four, repeated(label)) & 7) << (3 * r);
    }
    return bits;
  };
  const auto label_at = [&](unsigned position) {
    return labels_[first + (6 * (position / 9) + position / 3 % 3) * kRow + position % 3];
  };
  const std::uint32_t others = differing_from(label(place));
  const LabelIndex other = label_at(static_cast<unsigned>(std::countr_zero(others)));
  const bool has_two_labels = (others & differing_from(other)) == 0;
  return Neighborhood(others | static_cast<std::uint32_t>(has_two_labels) << 30);
}

}  // namespace podm
