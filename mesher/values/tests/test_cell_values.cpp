// Values on cells, against exact volumes that another way of clipping gives.
#include "values/cell_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>

#include "io/tests/kuhn_mesh.h"
#include "values/exact_numbers.h"
#include "values/grid_overlap.h"

namespace podm {
namespace {

using ExactTet = std::array<GridPoint<Rational>, 4>;
constexpr Affine kOblique{-0.7, 0.1, 0, 13, 0.05, 0.8, 0, -100, 0, 0.2, 1.25, 55};

Rational volume_of(const ExactTet& p) {
  GridPoint<Rational> a, b, c;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    a[axis] = p[1][axis] - p[0][axis];
    b[axis] = p[2][axis] - p[0][axis];
    c[axis] = p[3][axis] - p[0][axis];
  }
  const Rational determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                               a[2] * (b[0] * c[1] - b[1] * c[0]);
  return abs(determinant) / 6;
}

GridPoint<Rational> at_plane(const GridPoint<Rational>& p, const GridPoint<Rational>& q, std::size_t axis,
                             int plane) {
  const Rational share = (plane - p[axis]) / (q[axis] - p[axis]);
  GridPoint<Rational> point;
  for (std::size_t i = 0; i < 3; ++i) point[i] = p[i] + share * (q[i] - p[i]);
  return point;
}

// Appends tetrahedra that fill the part of `tet` on one side of the plane.
void clip(const ExactTet& tet, std::size_t axis, int plane, bool keeps_above, std::vector<ExactTet>& kept) {
  std::vector<GridPoint<Rational>> in, out;
  for (const auto& p : tet) (p[axis] == plane || (p[axis] > plane) == keeps_above ? in : out).push_back(p);
  const auto cut = [&](std::size_t i, std::size_t o) { return at_plane(in[i], out[o], axis, plane); };
  if (out.empty()) {
    kept.push_back(tet);
  } else if (in.size() == 1) {
    kept.push_back({in[0], cut(0, 0), cut(0, 1), cut(0, 2)});
  } else if (in.size() == 2) {  // a prism with the triangles of in[0] and of in[1]
    kept.push_back({in[0], cut(0, 0), cut(0, 1), in[1]});
    kept.push_back({cut(0, 0), cut(0, 1), in[1], cut(1, 0)});
    kept.push_back({cut(0, 1), in[1], cut(1, 0), cut(1, 1)});
  } else if (in.size() == 3) {  // a prism with the triangles of `in` and of the cuts
    kept.push_back({in[0], in[1], in[2], cut(0, 0)});
    kept.push_back({in[1], in[2], cut(0, 0), cut(1, 0)});
    kept.push_back({in[2], cut(0, 0), cut(1, 0), cut(2, 0)});
  }
}

Rational volume_in_voxel(const ExactTet& tet, const std::array<int, 3>& voxel) {
  std::vector<ExactTet> parts{tet};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int end : {0, 1}) {
      std::vector<ExactTet> kept;
      for (const ExactTet& part : parts) clip(part, axis, voxel[axis] + end, end == 0, kept);
      parts = std::move(kept);
    }
  }
  Rational sum = 0;
  for (const ExactTet& part : parts) sum += volume_of(part);
  return sum;
}

template <class Real>
Real signed_volume(const std::array<GridPoint<Real>, 4>& p) {
  const auto e = [&](std::size_t n, std::size_t axis) { return Real(p[n][axis] - p[0][axis]); };
  return Real(e(1, 0) * (e(2, 1) * e(3, 2) - e(2, 2) * e(3, 1)) +
              e(1, 1) * (e(2, 2) * e(3, 0) - e(2, 0) * e(3, 2)) +
              e(1, 2) * (e(2, 0) * e(3, 1) - e(2, 1) * e(3, 0)));
}

class RandomTets {
 public:
  explicit RandomTets(unsigned seed) : random_(seed) {}

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  // Returns a positively oriented tetrahedron around a point of the box. Some corners are corners of voxels.
  std::array<GridPoint<double>, 4> operator()(const std::array<double, 3>& box, double size,
                                              double flatness) {
    const auto flat_axis = static_cast<std::size_t>(number(0, 3));
    const bool is_on_grid = number(0, 1) < 0.2;
    for (;;) {
      std::array<GridPoint<double>, 4> tet;
      const GridPoint<double> center = {number(0, box[0]), number(0, box[1]), number(0, box[2])};
      for (auto& corner : tet)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          corner[axis] = center[axis] + number(-0.5, 0.5) * size * (axis == flat_axis ? flatness : 1);
          if (is_on_grid && axis != flat_axis) corner[axis] = std::round(corner[axis]);
        }
      ExactTet exact;
      for (std::size_t n = 0; n < 4; ++n)
        for (std::size_t axis = 0; axis < 3; ++axis) exact[n][axis] = tet[n][axis];
      const Rational volume = signed_volume(exact);
      if (volume == 0) continue;
      if (volume < 0) std::swap(tet[2], tet[3]);
      return tet;
    }
  }

 private:
  std::mt19937 random_;
};

TEST(GridOverlap, HasTheExactVolumes) {
  RandomTets tets(1);
  GridOverlap<Rational, ConstantField> overlap;
  GridOverlap<double, ConstantField> rounded;
  for (int n = 0; n < 60; ++n) {
    const auto tet = tets({0.5, 0.5, 0.5}, tets.number(0.5, 4), n % 3 == 0 ? 1e-3 : 1);
    ExactTet exact;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) exact[i][axis] = tet[i][axis];
    Rational sum = 0;
    std::vector<double> volumes;
    overlap(exact, [&](const auto& voxel, const auto& moments) {
      EXPECT_EQ(moments[0], volume_in_voxel(exact, voxel));
      volumes.push_back(static_cast<double>(moments[0]));
      sum += moments[0];
    });
    EXPECT_EQ(sum, volume_of(exact));
    double error = 0;
    std::size_t i = 0;
    rounded(tet, [&](const auto&, const auto& moments) { error += std::abs(moments[0] - volumes[i++]); });
    EXPECT_LE(error, rounded.volume_error() + 1e-15);
  }
}

ValueImage random_image(unsigned seed) {
  std::mt19937 random(seed);
  ValueImage image;
  image.size = {21, 17, 13};
  std::vector<float> values(21 * 17 * 13);
  for (float& value : values) value = std::floor(std::uniform_real_distribution<float>(-1000, 3000)(random));
  image.values = values;
  return image;
}

ExactTet in_grid(const TetMesh& mesh, std::size_t c) {
  const GridFrame frame(exact_affine(kOblique), 1);
  ExactTet tet;
  for (std::size_t n = 0; n < 4; ++n) tet[n] = frame.exact(mesh.vertices[mesh.cells[c][n]]);
  std::swap(tet[2], tet[3]);  // the affine mirrors
  return tet;
}

// Returns a mesh of unconnected cells in the frame of the oblique affine.
TetMesh mesh_of(RandomTets& tets, std::size_t count) {
  TetMesh mesh;
  while (mesh.cells.size() < count) {
    const double flatness = mesh.cells.size() % 4 == 0 ? std::pow(10, tets.number(-13, 0)) : 1;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& corner : tets({20, 16, 12}, tets.number(0.3, 4), flatness)) {
      const Point p = map(kOblique, Point{corner[0] - 0.5, corner[1] - 0.5, corner[2] - 0.5});
      mesh.vertices.push_back({p.x, p.y, p.z});
    }
    mesh.cells.push_back({first, first + 1, first + 3, first + 2});
    if (signed_volume(in_grid(mesh, mesh.cells.size() - 1)) <= 0)
      mesh.cells.pop_back();  // rounding inverts it
  }
  return mesh;
}

// The mean of a cell, by rational numbers throughout; none if the image covers hardly any of it.
std::optional<double> exact_mean(const TetMesh& mesh, std::size_t c, const ValueImage& image) {
  const ExactTet tet = in_grid(mesh, c);
  const auto& values = std::get<std::vector<float>>(image.values);
  Rational covered = 0, sum = 0;
  GridOverlap<Rational, ConstantField> overlap;
  overlap(tet, [&](const auto& voxel, const auto& moments) {
    std::size_t at = 0;
    for (const std::size_t axis : {2u, 1u, 0u}) {
      if (voxel[axis] < 0 || voxel[axis] >= image.size[axis]) return;
      at = at * static_cast<std::size_t>(image.size[axis]) + static_cast<std::size_t>(voxel[axis]);
    }
    covered += moments[0];
    sum += moments[0] * Rational(values[at]);
  });
  if (covered * 1000000000000 < volume_of(tet)) return std::nullopt;
  return static_cast<double>(Rational(sum / covered));
}

TEST(CellValues, MeansAreThoseOfRationalNumbers) {
  const std::size_t count = std::getenv("PODM_SLOW_TESTS") != nullptr ? 10000 : 300;
  RandomTets tets(2);
  const ValueImage image = random_image(3);
  const TetMesh mesh = mesh_of(tets, count);
  const auto of_cells = values_of_cells(mesh, image, exact_affine(kOblique), ValuesOf::kConstant, 2);
  std::size_t num_covered = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const auto mean = exact_mean(mesh, c, image);
    ASSERT_EQ(mean.has_value(), of_cells[c].covered_share > 0) << c;
    if (!mean) continue;
    ++num_covered;
    const double largest = std::max(std::abs(of_cells[c].least), std::abs(of_cells[c].largest));
    EXPECT_LE(std::abs(of_cells[c].mean - *mean), 1e-12 * largest) << c;
    EXPECT_GE(of_cells[c].mean, of_cells[c].least - 1e-9 * largest) << c;
    EXPECT_LE(of_cells[c].mean, of_cells[c].largest + 1e-9 * largest) << c;
  }
  EXPECT_GT(num_covered, count / 2);
}

TEST(CellValues, LinearFieldsAreReproduced) {
  RandomTets tets(4);
  ValueImage image = random_image(5);
  std::vector<double> values;
  const auto linear = [](double i, double j, double k) { return 1000 + 3 * i - 7 * j + 0.5 * k; };
  for (int k = 0; k < 13; ++k)
    for (int j = 0; j < 17; ++j)
      for (int i = 0; i < 21; ++i) values.push_back(linear(i, j, k));
  image.values = values;
  const TetMesh mesh = mesh_of(tets, 200);
  const auto of_cells = values_of_cells(mesh, image, exact_affine(kOblique), ValuesOf::kTrilinear, 2);
  std::size_t num_inside = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    std::array<double, 3> center{};
    bool is_inside = true;  // between the outermost voxel centers
    for (const std::uint32_t v : mesh.cells[c]) {
      const auto p = map(inverse(kOblique), mesh.vertices[v]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        center[axis] += p[axis] / 4;
        is_inside = is_inside && p[axis] > 0 && p[axis] < image.size[axis] - 1;
      }
    }
    if (!is_inside) continue;
    ++num_inside;
    EXPECT_NEAR(of_cells[c].mean, linear(center[0], center[1], center[2]), 1e-12 * of_cells[c].largest) << c;
    EXPECT_EQ(of_cells[c].covered_share, 1);
  }
  EXPECT_GT(num_inside, 50u);
}

TEST(CellValues, ConstantsAreReproducedAndSharesKnown) {
  ValueImage image;
  image.size = {2, 2, 2};
  image.values = std::vector<float>(8, 0.1f);
  TetMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {4, 0, 0}, {0, 4, 0},
                   {0, 0, 4}, {9, 9, 9},   {9, 9, 8},   {8, 9, 9},   {9, 8, 9}};
  mesh.cells = {{0, 1, 2, 3}, {0, 4, 5, 6}, {7, 8, 9, 10}};
  for (const ValuesOf of : {ValuesOf::kConstant, ValuesOf::kTrilinear}) {
    const auto of_cells =
        values_of_cells(mesh, image, exact_affine({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}), of, 1);
    for (const std::size_t c : {0u, 1u}) EXPECT_EQ(of_cells[c].mean, double{0.1f});
    EXPECT_EQ(of_cells[0].covered_share, 1);
    // The image ends at 1.5: the cube [0, 1.5]^3 less the corner beyond x + y + z = 4.
    EXPECT_NEAR(of_cells[1].covered_voxels, 3.375 - 0.125 / 6, 1e-14);
    EXPECT_NEAR(of_cells[1].covered_share, (3.375 - 0.125 / 6) / (64.0 / 6), 1e-14);
    EXPECT_EQ(of_cells[2].covered_share, 0);
  }
}

TEST(CellValues, AMeshThatFillsTheBoxHasTheSumOfTheVoxels) {
  const ValueImage image = random_image(6);
  TetMesh mesh = make_kuhn_mesh(5, 1, [](int, int, int) { return LabelIndex{1}; });
  std::array<double, 3> low = mesh.vertices.front(), high = low;
  for (const auto& v : mesh.vertices)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], v[axis]);
      high[axis] = std::max(high[axis], v[axis]);
    }
  for (auto& v : mesh.vertices)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double place = 5 * (v[axis] - low[axis]) / (high[axis] - low[axis]), nearest = std::round(place);
      const bool is_border = nearest == 0 || nearest == 5;
      v[axis] = (is_border ? nearest : place) / 5 * image.size[axis] - 0.5;
    }
  const auto of_cells = values_of_cells(mesh, image, exact_affine({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}),
                                        ValuesOf::kConstant, 2);
  double sum = 0, magnitude = 0, expected = 0;
  for (const CellValue& value : of_cells) sum += value.mean * value.covered_voxels;
  for (const float value : std::get<std::vector<float>>(image.values))
    expected += value, magnitude += std::abs(value);
  EXPECT_NEAR(sum, expected, 1e-10 * magnitude);
}

}  // namespace
}  // namespace podm
