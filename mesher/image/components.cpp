#include "image/components.h"

#include <algorithm>
#include <numeric>

namespace podm {

namespace {

// Union-find with path halving. The root of a set is its least member.
class Sets {
 public:
  explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void join(std::uint32_t x, std::uint32_t y) {
    const auto [low, high] = std::minmax({find(x), find(y)});
    parent_[high] = low;
  }
  std::vector<std::uint32_t> roots() {
    for (std::uint32_t x = 0; x < parent_.size(); ++x) parent_[x] = parent_[parent_[x]];
    return std::move(parent_);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

Components::Components(const LabelImage& image) : size_(image.size) {
  const std::vector<LabelIndex> label_of_run = cut_into_runs(image);
  Sets sets(runs_.size());
  const auto join = [&](std::size_t a, std::size_t b) {
    for_each_overlap(runs_of_row(a), runs_of_row(b), [&](const Run& of_a, const Run& of_b, int) {
      if (label_of_run[of_a.component] == label_of_run[of_b.component])
        sets.join(of_a.component, of_b.component);
    });
  };
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j) {
      if (j > 0) join(row(j - 1, k), row(j, k));
      if (k > 0) join(row(j, k - 1), row(j, k));
    }
  number(sets.roots(), label_of_run);
}

// Each run is its own component at first.
std::vector<LabelIndex> Components::cut_into_runs(const LabelImage& image) {
  std::vector<LabelIndex> label_of_run;
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j) {
      first_run_.push_back(runs_.size());
      const LabelIndex* const voxels = &image.voxels[image.index(0, j, k)];
      for (int i = 0; i < size_[0]; ++i)
        if (i == 0 || voxels[i] != voxels[i - 1]) {
          runs_.push_back({i, static_cast<Id>(runs_.size())});
          label_of_run.push_back(voxels[i]);
        }
    }
  first_run_.push_back(runs_.size());
  return label_of_run;
}

void Components::number(const std::vector<Id>& root_of_run, const std::vector<LabelIndex>& label_of_run) {
  std::vector<Id> number_of_root(runs_.size());
  for_each_run([&](Id run, const Voxel& first, int length) {
    if (root_of_run[run] == run) {
      number_of_root[run] = static_cast<Id>(components_.size());
      components_.push_back({label_of_run[run], 0, first});
    }
    components_[number_of_root[root_of_run[run]]].num_voxels += static_cast<std::uint64_t>(length);
  });
  for (Run& run : runs_) run.component = number_of_root[root_of_run[run.component]];
}

Components::Id Components::of(const Voxel& v) const {
  const auto runs = runs_of_row(row(v.j, v.k));
  const auto after =
      std::upper_bound(runs.begin(), runs.end(), v.i, [](int i, const Run& run) { return i < run.begin; });
  return std::prev(after)->component;
}

}  // namespace podm
