#include "image/image_topology.h"

#include <array>
#include <bit>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "parallel.h"

namespace podm::verify {

namespace {

// --- Components, by runs of equal voxels along x ---------------------------------------------------------

struct Run {
  int first, last;
  std::uint32_t label;
};

struct Runs {
  std::vector<Run> runs;
  std::vector<std::size_t> row_begin;  // row j + k * size[1]; one more at the end
};

// If `is_merged`, every label counts as 1.
Runs find_runs(const Image& image, bool is_merged) {
  Runs result;
  const std::size_t rows = static_cast<std::size_t>(image.size[1]) * static_cast<std::size_t>(image.size[2]);
  const std::uint32_t* voxel = image.voxels.data();
  for (std::size_t row = 0; row < rows; ++row, voxel += image.size[0]) {
    result.row_begin.push_back(result.runs.size());
    for (int i = 0; i < image.size[0]; ++i) {
      if (voxel[i] == 0) continue;
      const std::uint32_t label = is_merged ? 1 : voxel[i];
      const bool goes_on = i > 0 && voxel[i - 1] != 0 && (is_merged || voxel[i - 1] == label);
      if (goes_on)
        result.runs.back().last = i;
      else
        result.runs.push_back({i, i, label});
    }
  }
  result.row_begin.push_back(result.runs.size());
  return result;
}

class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t i, std::size_t j) { parent_[root(i)] = root(j); }

 private:
  std::vector<std::size_t> parent_;
};

// Unites the runs of two rows that overlap, or, with reach 1, that meet at an edge or corner.
void unite_rows(const Runs& runs, std::size_t row, std::size_t other, int reach, Sets& sets) {
  std::size_t start = runs.row_begin[other];
  for (std::size_t i = runs.row_begin[row]; i < runs.row_begin[row + 1]; ++i) {
    const Run& run = runs.runs[i];
    while (start < runs.row_begin[other + 1] && runs.runs[start].last + reach < run.first) ++start;
    for (std::size_t j = start; j < runs.row_begin[other + 1] && runs.runs[j].first <= run.last + reach; ++j)
      if (runs.runs[j].label == run.label) sets.unite(i, j);
  }
}

std::unordered_map<std::uint32_t, std::uint64_t> count_components(const Image& image, const Runs& runs,
                                                                  bool is_26) {
  Sets sets(runs.runs.size());
  const int reach = is_26 ? 1 : 0;
  const auto rows = static_cast<std::size_t>(image.size[1]);
  for (int k = 0; k < image.size[2]; ++k)
    for (int j = 0; j < image.size[1]; ++j) {
      const std::size_t row = static_cast<std::size_t>(k) * rows + static_cast<std::size_t>(j);
      if (j > 0) unite_rows(runs, row, row - 1, reach, sets);
      if (k == 0) continue;
      unite_rows(runs, row, row - rows, reach, sets);
      if (is_26 && j > 0) unite_rows(runs, row, row - rows - 1, reach, sets);
      if (is_26 && j + 1 < image.size[1]) unite_rows(runs, row, row - rows + 1, reach, sets);
    }
  std::unordered_map<std::uint32_t, std::uint64_t> counts;
  for (std::size_t i = 0; i < runs.runs.size(); ++i)
    if (sets.root(i) == i) ++counts[runs.runs[i].label];
  return counts;
}

// --- Euler numbers, by the eight voxels around each corner of the grid -----------------------------------

struct Share {
  int euler_6 = 0, euler_26 = 0;
};

// Each element of a complex (point, edge, square or cube) belongs to one corner: the corner whose last voxel,
// of the eight around it, is the element's last voxel. Bit x + 2y + 4z of the mask is set if that voxel has
// the label. A full mask adds nothing, nor does an empty one.
constexpr Share share_of(unsigned mask) {
  const auto all = [mask](unsigned bits) { return (mask & bits) == bits ? 1 : 0; };
  const auto any = [mask](unsigned bits) { return (mask & bits) != 0 ? 1 : 0; };
  return {all(0x80) - (all(0xC0) + all(0xA0) + all(0x88)) + (all(0xF0) + all(0xCC) + all(0xAA)) - all(0xFF),
          any(0xFF) - (any(0xAA) + any(0xCC) + any(0xF0)) + (any(0x88) + any(0xA0) + any(0xC0)) - any(0x80)};
}

constexpr auto kShares = [] {
  std::array<Share, 256> shares{};
  for (unsigned mask = 0; mask < 256; ++mask) shares[mask] = share_of(mask);
  return shares;
}();
static_assert(kShares[0xFF].euler_6 == 0 && kShares[0xFF].euler_26 == 0);

struct EulerSums {
  std::unordered_map<std::uint32_t, std::array<std::int64_t, 2>> of_label;
  std::array<std::int64_t, 2> all{};

  static void add(std::array<std::int64_t, 2>& sum, unsigned mask) {
    sum[0] += kShares[mask].euler_6;
    sum[1] += kShares[mask].euler_26;
  }
  void add(const std::array<std::uint32_t, 8>& labels) {
    unsigned left = 0;
    for (unsigned c = 0; c < 8; ++c) left |= (labels[c] != 0 ? 1U : 0U) << c;
    add(all, left);
    while (left != 0) {
      const std::uint32_t label = labels[static_cast<std::size_t>(std::countr_zero(left))];
      unsigned mask = 0;
      for (unsigned c = 0; c < 8; ++c) mask |= (labels[c] == label ? 1U : 0U) << c;
      add(of_label[label], mask);
      left &= ~mask;
    }
  }
};

// Adds the corners of slice k. The last of the eight voxels around corner (i,j,k) is voxel (i,j,k).
void add_slice(const Image& image, int k, const std::vector<std::uint32_t>& empty_row, EulerSums& sums) {
  const auto row = [&](int j, int slice) {
    if (j < 0 || slice < 0 || j >= image.size[1] || slice >= image.size[2]) return empty_row.data();
    return image.voxels.data() + (static_cast<std::size_t>(slice) * static_cast<std::size_t>(image.size[1]) +
                                  static_cast<std::size_t>(j)) *
                                     static_cast<std::size_t>(image.size[0]);
  };
  for (int j = 0; j <= image.size[1]; ++j) {
    const std::array<const std::uint32_t*, 4> rows{row(j - 1, k - 1), row(j, k - 1), row(j - 1, k),
                                                   row(j, k)};
    std::array<std::uint32_t, 8> labels{};
    for (int i = 0; i <= image.size[0]; ++i) {
      std::uint32_t difference = 0;
      for (std::size_t r = 0; r < 4; ++r) {
        labels[2 * r] = labels[2 * r + 1];
        labels[2 * r + 1] = i < image.size[0] ? rows[r][i] : 0;
        difference |= (labels[2 * r] ^ labels[0]) | (labels[2 * r + 1] ^ labels[0]);
      }
      if (difference != 0) sums.add(labels);
    }
  }
}

}  // namespace

ImageTopology find_topology(const Image& image, int threads) {
  ImageTopology topology;
  const Runs runs = find_runs(image, false), merged = find_runs(image, true);
  for (const Run& run : runs.runs) {
    const auto length = static_cast<std::uint64_t>(run.last - run.first + 1);
    topology.of_label[run.label].voxels += length;
    topology.all.voxels += length;
  }
  const auto of_6 = count_components(image, runs, false), of_26 = count_components(image, runs, true);
  for (auto& [label, t] : topology.of_label) {
    t.components_6 = of_6.at(label);
    t.components_26 = of_26.at(label);
  }
  if (topology.all.voxels > 0) {
    topology.all.components_6 = count_components(image, merged, false).at(1);
    topology.all.components_26 = count_components(image, merged, true).at(1);
  }

  std::vector<EulerSums> sums(static_cast<std::size_t>(threads));
  const std::vector<std::uint32_t> empty_row(static_cast<std::size_t>(image.size[0]), 0);
  parallel_ranges(static_cast<std::size_t>(image.size[2]) + 1, threads,
                  [&](std::size_t begin, std::size_t end, std::size_t thread) {
                    for (std::size_t k = begin; k < end; ++k)
                      add_slice(image, static_cast<int>(k), empty_row, sums[thread]);
                  });
  for (const EulerSums& part : sums) {
    for (const auto& [label, sum] : part.of_label) {
      topology.of_label[label].euler_6 += sum[0];
      topology.of_label[label].euler_26 += sum[1];
    }
    topology.all.euler_6 += part.all[0];
    topology.all.euler_26 += part.all[1];
  }
  return topology;
}

}  // namespace podm::verify
