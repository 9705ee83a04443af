#include "lines/lattice.h"

#include <algorithm>

namespace podm {

namespace {

// Combines the values at the eight corners of each cube. Cubes that would reach beyond the lattice have
// undefined values.
template <class Value, class Combine>
void combine_corners(std::array<Value, kLatticePoints>& field, const Combine& combine) {
  for (const std::size_t stride : {std::size_t{1}, kLatticeRow, kLatticeSlice})
    for (std::size_t i = 0; i + stride < kLatticePoints; ++i)
      field[i] = static_cast<Value>(combine(field[i], field[i + stride]));
}

// The lattice of the finest boxes, in steps per block.
constexpr int kFinest = 8 * kLatticeSteps;

// The exact value of a form, which is at most 2^16 in each corner, in units of kFinest^-3.
std::int64_t exact_value(const WeightForms::Corners& corners, int x, int y, int z) {
  std::int64_t sum = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    const std::int64_t share = std::int64_t{(c & 1) != 0 ? x : kFinest - x} *
                               ((c & 2) != 0 ? y : kFinest - y) * ((c & 4) != 0 ? z : kFinest - z);
    sum += share * corners[c];
  }
  return sum;
}

// The slots that may win in a box with this lowest corner and side. A form's extrema in a box are at its
// corners. So slot l beats slot m in the box if it does at all corners.
SlotMask possible_in_box(const WeightForms& forms, int x, int y, int z, int side) {
  std::array<std::array<std::int64_t, 8>, WeightForms::kMostSlots> values;
  for (std::size_t s = 0; s < forms.size(); ++s)
    for (int c = 0; c < 8; ++c)
      values[s][static_cast<std::size_t>(c)] =
          exact_value(forms.corners(s), x + side * (c & 1), y + side * (c >> 1 & 1), z + side * (c >> 2));
  SlotMask possible = 0;
  for (std::size_t m = 0; m < forms.size(); ++m) {
    bool is_beaten = false;
    for (std::size_t l = 0; l < forms.size() && !is_beaten; ++l) {
      if (l == m) continue;
      is_beaten = true;
      for (std::size_t c = 0; c < 8; ++c)
        is_beaten &= l < m ? values[l][c] >= values[m][c] : values[l][c] > values[m][c];
    }
    if (!is_beaten) possible |= static_cast<SlotMask>(1u << m);
  }
  return possible;
}

std::optional<Point> place_of_three(const WeightForms& forms, const std::array<int, 3>& low, int side,
                                    SlotMask counting) {
  if (num_slots(possible_in_box(forms, low[0], low[1], low[2], side) & counting) < 3) return std::nullopt;
  if (side == 1) {
    constexpr double kUnit = 1.0 / kFinest;
    return Point{(low[0] + 0.5) * kUnit, (low[1] + 0.5) * kUnit, (low[2] + 0.5) * kUnit};
  }
  const int half = side / 2;
  for (int c = 0; c < 8; ++c)
    if (const auto place = place_of_three(
            forms, {low[0] + half * (c & 1), low[1] + half * (c >> 1 & 1), low[2] + half * (c >> 2)}, half,
            counting))
      return place;
  return std::nullopt;
}

}  // namespace

void BlockLattice::sample_slot(const WeightForms::Corners& corners, Field<std::int32_t>& weights) const {
  constexpr auto kSteps = kLatticeSteps;
  std::array<std::array<std::int32_t, kLatticeRow>, 4> rows;
  for (std::size_t r = 0; r < 4; ++r)
    for (int x = 0; x <= kSteps; ++x)
      rows[r][static_cast<std::size_t>(x)] = corners[2 * r] * (kSteps - x) + corners[2 * r + 1] * x;
  std::array<std::array<std::int32_t, kLatticeSlice>, 2> slices;
  for (std::size_t z = 0; z < 2; ++z)
    for (int y = 0; y <= kSteps; ++y)
      for (std::size_t x = 0; x < kLatticeRow; ++x)
        slices[z][kLatticeRow * static_cast<std::size_t>(y) + x] =
            rows[2 * z][x] * (kSteps - y) + rows[2 * z + 1][x] * y;
  for (int z = 0; z <= kSteps; ++z)
    for (std::size_t i = 0; i < kLatticeSlice; ++i)
      weights[kLatticeSlice * static_cast<std::size_t>(z) + i] =
          slices[0][i] * (kSteps - z) + slices[1][i] * z;
}

// The first of two equal weights wins, which is that of the lower label.
void BlockLattice::sample(const WeightForms& forms) {
  num_slots_ = forms.size();
  all_ = static_cast<SlotMask>((1u << num_slots_) - 1);
  for (std::size_t s = 0; s < num_slots_; ++s) sample_slot(forms.corners(s), weights_[s]);
  Field<std::int32_t> greatest = weights_[0];
  winners_.fill(1);
  for (std::size_t s = 1; s < num_slots_; ++s) {
    const auto own = static_cast<SlotMask>(1u << s);
    const Field<std::int32_t>& weights = weights_[s];
    for (std::size_t i = 0; i < kLatticePoints; ++i) {
      winners_[i] = weights[i] > greatest[i] ? own : winners_[i];
      greatest[i] = std::max(weights[i], greatest[i]);
    }
  }
  present_ = 0;
  for (const SlotMask winner : winners_) present_ |= winner;
  of_cubes_ = winners_;
  combine_corners(of_cubes_, [](auto a, auto b) { return a | b; });
}

void BlockLattice::rule_out() {
  beaten_.fill(0);
  Field<std::uint8_t> leads, trails;
  for (std::size_t l = 0; l < num_slots_; ++l) {
    for (std::size_t m = l + 1; m < num_slots_; ++m) {
      for (std::size_t i = 0; i < kLatticePoints; ++i) leads[i] = weights_[l][i] >= weights_[m][i];
      trails = leads;
      combine_corners(leads, [](auto a, auto b) { return a & b; });
      combine_corners(trails, [](auto a, auto b) { return a | b; });
      for (std::size_t i = 0; i < kLatticePoints; ++i)
        beaten_[i] |= static_cast<SlotMask>(leads[i] << m | (trails[i] ^ 1) << l);
    }
  }
}

std::optional<Point> place_of_three(const WeightForms& forms, std::size_t cube, SlotMask counting) {
  constexpr int kSide = kFinest / kLatticeSteps;
  return place_of_three(
      forms, {kSide * lattice_steps(cube, 0), kSide * lattice_steps(cube, 1), kSide * lattice_steps(cube, 2)},
      kSide, counting);
}

}  // namespace podm
