// The lattice on which a block's labels are sampled, and its triangulation.
//
// A block has 8 steps along each axis, thus 9^3 lattice points. Weights there are whole numbers: forms have
// whole values at the corners, and are interpolated in units of 1/8 per axis. Labels at lattice points are
// therefore exact, ties included, and two blocks agree on those of their common face. A tie goes to the lower
// label, as if label l had a bonus of e^l with an infinitesimal e. No three labels tie where this perturbed
// function is generic, except along curves; so a label that loses everywhere in a box can be ruled out
// exactly, by the corners of the box.
//
// The lattice cubes are cut into six tetrahedra each, by Freudenthal and Kuhn: the corners of a tetrahedron
// are 0, x, xy, xyz of the cube, for one order of the axes. The triangulation is the same in all cubes, and
// the one of a face does not depend on the block. A simplex is named by its lowest vertex and its steps: sets
// of axes (bit a: axis a) by which its next vertices are higher.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "geometry/box.h"
#include "lines/weight_forms.h"

namespace podm {

inline constexpr int kLatticeSteps = 8;
inline constexpr double kLatticeSide = 1.0 / kLatticeSteps;
inline constexpr std::size_t kLatticeRow = kLatticeSteps + 1;
inline constexpr std::size_t kLatticeSlice = kLatticeRow * kLatticeRow;
inline constexpr std::size_t kLatticePoints = kLatticeSlice * kLatticeRow;

/// The part of a block that counts, in steps: the whole block, or the half inside a flat box.
struct LatticeRange {
  std::array<int, 3> low{0, 0, 0}, high{kLatticeSteps, kLatticeSteps, kLatticeSteps};

  Box box() const {
    return {{low[0] * kLatticeSide, low[1] * kLatticeSide, low[2] * kLatticeSide},
            {high[0] * kLatticeSide, high[1] * kLatticeSide, high[2] * kLatticeSide}};
  }
};

/// The number of a lattice point: x + 9 y + 81 z.
constexpr std::size_t lattice_index(int x, int y, int z) {
  return static_cast<std::size_t>(x) + kLatticeRow * static_cast<std::size_t>(y) +
         kLatticeSlice * static_cast<std::size_t>(z);
}
/// The number of steps along axis `a` to a lattice point.
constexpr int lattice_steps(std::size_t index, std::size_t axis) {
  constexpr std::array<std::size_t, 3> kStride{1, kLatticeRow, kLatticeSlice};
  return static_cast<int>(index / kStride[axis] % kLatticeRow);
}
/// The difference in number by a set of axes.
constexpr std::size_t lattice_offset(unsigned axes) {
  return (axes & 1) + (axes >> 1 & 1) * kLatticeRow + (axes >> 2 & 1) * kLatticeSlice;
}
inline Point lattice_point(std::size_t index) {
  return {lattice_steps(index, 0) * kLatticeSide, lattice_steps(index, 1) * kLatticeSide,
          lattice_steps(index, 2) * kLatticeSide};
}

/// A triangle of the lattice: its lowest vertex, and the steps to the second and from there to the third.
struct LatticeTriangle {
  std::uint16_t vertex;
  std::uint8_t first_step, second_step;

  std::array<std::size_t, 3> vertices() const {
    const std::size_t second = vertex + lattice_offset(first_step);
    return {vertex, second, second + lattice_offset(second_step)};
  }
  Point centroid() const {
    const auto [a, b, c] = vertices();
    return (1.0 / 3) * (lattice_point(a) + lattice_point(b) + lattice_point(c));
  }
};

/// The labels at the lattice points of a block. Memory of one thread, reused from block to block.
class BlockLattice {
 public:
  /// Samples the forms.
  void sample(const WeightForms& forms);

  /// The set of one slot that wins at a lattice point.
  SlotMask winner(std::size_t index) const { return winners_[index]; }
  /// The slots that win at the corners of the lattice cube with this lowest vertex.
  SlotMask winners_of_cube(std::size_t index) const { return of_cubes_[index]; }
  /// The slots that may win in the cube. Any other slot loses everywhere in it.
  SlotMask possible_in_cube(std::size_t index) const { return static_cast<SlotMask>(all_ & ~beaten_[index]); }
  /// True if three slots or more win at lattice points.
  bool has_three_winners() const { return num_slots(present_) > 2; }
  /// Finds all slots that possible_in_cube() rules out. winners_of_cube() is known without it.
  void rule_out();

 private:
  template <class Value>
  using Field = std::array<Value, kLatticePoints>;
  void sample_slot(const WeightForms::Corners& corners, Field<std::int32_t>& weights) const;

  std::size_t num_slots_ = 0;
  SlotMask all_ = 0, present_ = 0;
  std::array<Field<std::int32_t>, WeightForms::kMostSlots> weights_;
  Field<SlotMask> winners_, of_cubes_, beaten_;
};

/// The center of a box of 1/8 of the cube's side where three of the slots `counting` may still win, if there
/// is one. The test is exact for each box that it looks at.
std::optional<Point> place_of_three(const WeightForms& forms, std::size_t cube, SlotMask counting);

}  // namespace podm
