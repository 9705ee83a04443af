// Components of an image's labels, including the background: maximal sets of voxels of one label that are
// joined by faces. Only faces join the regions of a label: along an edge or at a corner their isosurfaces
// pinch.
//
// Rows along x are cut into runs of one label. Runs of neighboring rows that share a face are joined. A
// segmentation has tens of times fewer runs than voxels.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "image/voxel.h"
#include "podm/label_image.h"

namespace podm {

struct Component {
  LabelIndex label;
  std::uint64_t num_voxels = 0;
  Voxel first;  ///< the first of its voxels, x fastest
};

class Components {
 public:
  using Id = std::uint32_t;
  static constexpr Id kOutside = std::numeric_limits<Id>::max();

  /// Numbers the components by their first voxels. The image is not kept.
  explicit Components(const LabelImage& image);

  std::size_t size() const { return components_.size(); }
  const Component& operator[](Id component) const { return components_[component]; }
  Id of(const Voxel& v) const;

  /// Calls visit(component, first voxel, length) for each run of `length` voxels along x.
  template <class Visit>
  void for_each_run(const Visit& visit) const;
  /// Calls visit(a, b, axis, faces) for the faces between two components across the axis, a few at a time and
  /// each face once. Everything beyond the grid is the component kOutside, which is always b.
  template <class Visit>
  void for_each_contact(const Visit& visit) const;

 private:
  struct Run {
    int begin;
    Id component;
  };
  std::span<const Run> runs_of_row(std::size_t row) const {
    return {&runs_[first_run_[row]], first_run_[row + 1] - first_run_[row]};
  }
  std::size_t row(int j, int k) const {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j);
  }
  /// The end of run `r` of a row.
  int end_of(std::span<const Run> row, std::size_t r) const {
    return r + 1 < row.size() ? row[r + 1].begin : size_[0];
  }
  /// Calls visit(run of a, run of b, length) for each stretch along x that two runs share.
  template <class Visit>
  void for_each_overlap(std::span<const Run> a, std::span<const Run> b, const Visit& visit) const;
  std::vector<LabelIndex> cut_into_runs(const LabelImage& image);
  void number(const std::vector<Id>& root_of_run, const std::vector<LabelIndex>& label_of_run);

  std::array<int, 3> size_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_run_;  // by row, followed by the end of the last row
  std::vector<Component> components_;
};

template <class Visit>
void Components::for_each_run(const Visit& visit) const {
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j) {
      const auto runs = runs_of_row(row(j, k));
      for (std::size_t r = 0; r < runs.size(); ++r)
        visit(runs[r].component, Voxel{runs[r].begin, j, k}, end_of(runs, r) - runs[r].begin);
    }
}

template <class Visit>
void Components::for_each_overlap(std::span<const Run> a, std::span<const Run> b, const Visit& visit) const {
  for (std::size_t ra = 0, rb = 0; ra < a.size() && rb < b.size();) {
    const int end_a = end_of(a, ra), end_b = end_of(b, rb);
    visit(a[ra], b[rb], std::min(end_a, end_b) - std::max(a[ra].begin, b[rb].begin));
    ra += end_a <= end_b;
    rb += end_b <= end_a;
  }
}

template <class Visit>
void Components::for_each_contact(const Visit& visit) const {
  const Run outside{0, kOutside};
  const auto between_rows = [&](std::span<const Run> a, std::span<const Run> b, unsigned axis) {
    for_each_overlap(a, b, [&](const Run& of_a, const Run& of_b, int length) {
      if (of_a.component != of_b.component) visit(of_a.component, of_b.component, axis, length);
    });
  };
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j) {
      const auto runs = runs_of_row(row(j, k));
      visit(runs.front().component, kOutside, 0u, 1);
      visit(runs.back().component, kOutside, 0u, 1);
      for (std::size_t r = 1; r < runs.size(); ++r) visit(runs[r - 1].component, runs[r].component, 0u, 1);
      if (j == 0) between_rows(runs, {&outside, 1}, 1);
      between_rows(runs, j + 1 < size_[1] ? runs_of_row(row(j + 1, k)) : std::span(&outside, 1), 1);
      if (k == 0) between_rows(runs, {&outside, 1}, 2);
      between_rows(runs, k + 1 < size_[2] ? runs_of_row(row(j, k + 1)) : std::span(&outside, 1), 2);
    }
}

}  // namespace podm
