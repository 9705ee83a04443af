#include "distributed/read_by_bricks.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "distributed/collective_errors.h"
#include "distributed/image_digest.h"
#include "distributed/messages.h"
#include "image/image_by_bricks.h"
#include "image/interface_sides.h"
#include "image/label_selection.h"
#include "image/rows_of_image.h"
#include "isosurface/surface_masks.h"

namespace podm {

namespace {

// Chunks of a slab have about this many voxels.
constexpr std::size_t kChunk = 1 << 26;

// Layers of bricks.
struct Layers {
  int first, end;
};

Layers layers_of(int rank, int num_ranks, int num_layers) {
  const auto first = [&](int r) { return static_cast<int>(std::int64_t{num_layers} * r / num_ranks); };
  return {first(rank), first(rank + 1)};
}

// Calls use(layers) for parts of a slab that fit in memory.
template <class Use>
void for_each_chunk(const LabelImage& grid, const Layers& slab, const Use& use) {
  const std::size_t of_layer = 4 * unsigned_of(grid.size[0]) * unsigned_of(grid.size[1]);
  const int length = static_cast<int>(std::clamp<std::size_t>(kChunk / of_layer, 1, 1 << 20));
  for (int first = slab.first; first < slab.end; first += length)
    use(Layers{first, std::min(first + length, slab.end)});
}

LabelImage read_slices(const VoxelFile& file, int low, int high, std::size_t threads) {
  const auto [x, y, z] = file.grid().size;
  return file.read({0, 0, std::max(0, low)}, {x, y, std::min(high, z)}, threads);
}

// The labels of the image and the values in the file that have them.
class LabelsOfValues {
 public:
  LabelsOfValues(std::vector<std::uint32_t> values, std::vector<LabelIndex> labels)
      : values_(std::move(values)), labels_(std::move(labels)) {}

  /// Turns the values of a part of the file into the labels of the image.
  void apply(const std::string& path, LabelImage& part, std::size_t threads) const {
    constexpr std::size_t kLength = 1 << 18;
    std::vector<LabelIndex> new_label;
    for (const Label& label : part.labels) {
      const auto found = std::lower_bound(values_.begin(), values_.end(), label.value);
      if (found == values_.end() || *found != label.value)
        throw InputError(path + ": its voxels changed during the run");
      new_label.push_back(labels_[static_cast<std::size_t>(found - values_.begin())]);
    }
    parallel_for_ranges(part.voxels.size(), kLength, threads,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t i = begin; i < end; ++i)
                            part.voxels[i] = new_label[part.voxels[i]];
                        });
  }

 private:
  std::vector<std::uint32_t> values_;
  std::vector<LabelIndex> labels_;  // by position in `values_`
};

// Numbers that add up over the slabs.
struct Census {
  std::vector<std::uint64_t> voxels_of_label;
  std::array<std::uint64_t, 3> sides{};
  std::array<int, 3> low, high{-1, -1, -1};

  void operator+=(const Census& b) {
    for (std::size_t label = 0; label < voxels_of_label.size(); ++label)
      voxels_of_label[label] += b.voxels_of_label[label];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sides[axis] += b.sides[axis];
      low[axis] = std::min(low[axis], b.low[axis]);
      high[axis] = std::max(high[axis], b.high[axis]);
    }
  }
  // Adds a row of a part that begins at slice `first`.
  void add_row(const LabelImage& part, int first, int j, int k) {
    for (std::size_t axis = 0; axis < 3; ++axis) sides[axis] += count_sides(part, axis, 1, j, k);
    const auto row = std::span(part.voxels).subspan(part.index(0, j, k), unsigned_of(part.size[0]));
    for (auto from = row.begin(); from != row.end();) {
      const auto to = std::find_if(from, row.end(), [&](LabelIndex label) { return label != *from; });
      voxels_of_label[*from] += static_cast<std::uint64_t>(to - from);
      if (*from != kBackground)
        add_bounds({static_cast<int>(from - row.begin()), j, first + k},
                   {static_cast<int>(to - row.begin()) - 1, j, first + k});
      from = to;
    }
  }

 private:
  void add_bounds(const std::array<int, 3>& least, const std::array<int, 3>& most) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], least[axis]);
      high[axis] = std::max(high[axis], most[axis]);
    }
  }
};

// The labels of bricks and the numbers of one slab.
struct Slab {
  std::vector<LabelIndex> label_of_brick;
  std::vector<std::string> digests;  // by layer
  Census census;
};

class ReadSlab {
 public:
  ReadSlab(const VoxelFile& file, const LabelsOfValues& labels, std::size_t num_labels, int threads)
      : file_(file),
        labels_(labels),
        threads_(threads),
        slab_{
            .label_of_brick = {},
            .digests = {},
            .census = {.voxels_of_label = std::vector<std::uint64_t>(num_labels), .low = file.grid().size}} {}

  Slab operator()(const Layers& slab) {
    for_each_chunk(file_.grid(), slab, [&](const Layers& layers) { add(layers); });
    return std::move(slab_);
  }

 private:
  // A layer more on either side, or a slice, gives the neighbors of the voxels.
  void add(const Layers& layers) {
    const int before = std::max(0, layers.first - 1);
    LabelImage part = read_slices(file_, 4 * before, 4 * layers.end + 1, num_threads(threads_));
    labels_.apply(file_.path(), part, num_threads(threads_));
    const Layers here{layers.first - before, layers.end - before};
    add_bricks(part, here);
    add_census(part, here, 4 * before);
    const std::vector<std::string> more = digests_of_layers(part, here.first, here.end, threads_);
    slab_.digests.insert(slab_.digests.end(), more.begin(), more.end());
  }

  void add_bricks(const LabelImage& part, const Layers& layers) {
    const BrickGrid bricks(part.size);
    SurfaceMasks masks(bricks.count());
    mark_surface(part, bricks, num_threads(threads_), masks);
    const auto [x, y, z] = bricks.size();
    for (int k = layers.first; k < layers.end; ++k)
      for (int j = 0; j < y; ++j)
        for (int i = 0; i < x; ++i)
          slab_.label_of_brick.push_back(masks[bricks.index(i, j, k)] != 0
                                             ? ImageByBricks::kMixed
                                             : part.voxels[part.index(4 * i, 4 * j, 4 * k)]);
  }

  void add_census(const LabelImage& part, const Layers& layers, int first_slice) {
    const Census none{.voxels_of_label = std::vector<std::uint64_t>(slab_.census.voxels_of_label.size()),
                      .low = file_.grid().size};
    slab_.census += sum_over_rows(part, threads_, none, [&](Census& sum, int j, int k) {
      if (k >= 4 * layers.first && k < 4 * layers.end) sum.add_row(part, first_slice, j, k);
    });
  }

  const VoxelFile& file_;
  const LabelsOfValues& labels_;
  const int threads_;
  Slab slab_;
};

// A label and the number of consecutive bricks that have it.
struct Run {
  std::uint32_t label, length;
};

std::vector<Run> runs_of(const std::vector<LabelIndex>& labels) {
  std::vector<Run> runs;
  for (const LabelIndex label : labels) {
    if (runs.empty() || runs.back().label != label || runs.back().length == ~0u) runs.push_back({label, 0});
    ++runs.back().length;
  }
  return runs;
}

Bytes message_of(const Slab& slab) {
  Bytes message;
  append(message, runs_of(slab.label_of_brick));
  std::string digests;
  for (const std::string& digest : slab.digests) digests += digest;
  append(message, std::span<const char>(digests));
  append(message, slab.census.voxels_of_label);
  append(message, std::span<const std::uint64_t>(slab.census.sides));
  append(message, std::span<const int>(slab.census.low));
  append(message, std::span<const int>(slab.census.high));
  return message;
}

// Adds the slab of the next rank.
void add_slab(const Bytes& message, Slab& sum) {
  constexpr std::size_t kHexadecimal = 64;
  MessageReader reader(message);
  for (const Run& run : reader.read<Run>())
    sum.label_of_brick.insert(sum.label_of_brick.end(), run.length, static_cast<LabelIndex>(run.label));
  const std::vector<char> digests = reader.read<char>();
  for (std::size_t at = 0; at < digests.size(); at += kHexadecimal)
    sum.digests.emplace_back(digests.data() + at, kHexadecimal);
  Census census{.voxels_of_label = reader.read<std::uint64_t>(), .low = {}};
  std::ranges::copy(reader.read<std::uint64_t>(), census.sides.begin());
  std::ranges::copy(reader.read<int>(), census.low.begin());
  std::ranges::copy(reader.read<int>(), census.high.begin());
  reader.expect_end();
  sum.census += census;
}

std::shared_ptr<const ImageByBricks> image_of(LabelImage&& grid, std::shared_ptr<const VoxelFile> file,
                                              std::shared_ptr<const LabelsOfValues> labels,
                                              const std::vector<Bytes>& slabs) {
  auto image = std::make_shared<ImageByBricks>();
  static_cast<LabelImage&>(*image) = std::move(grid);
  Slab sum{
      .label_of_brick = {},
      .digests = {},
      .census = {.voxels_of_label = std::vector<std::uint64_t>(image->labels.size()), .low = image->size}};
  for (const Bytes& message : slabs) add_slab(message, sum);
  image->label_of_brick = std::move(sum.label_of_brick);
  image->voxels_of_label = std::move(sum.census.voxels_of_label);
  image->low = sum.census.low;
  image->high = sum.census.high;
  image->sides = sum.census.sides;
  image->digest = digest_of_layers(sum.digests);
  image->read = [file = std::move(file), labels = std::move(labels)](const Voxel& low, const Voxel& high) {
    LabelImage part = file->read(low, high, 1);
    labels->apply(file->path(), part, 1);
    return part;
  };
  return image;
}

void expect_one_file(const VoxelFile& file, Communication& ranks) {
  const LabelImage& grid = file.grid();
  expect_agreement({{"image", fmt::format("{} voxels of type {}, affine {}", fmt::join(grid.size, " x "),
                                          static_cast<int>(file.type()), fmt::join(grid.voxel_to_ras, " "))}},
                   ranks);
}

// Collective. Returns the values in the file.
std::vector<std::uint32_t> values_in(const VoxelFile& file, const Layers& slab, int threads,
                                     Communication& ranks) {
  std::set<std::uint32_t> own, all;
  const auto read = [&] {
    for_each_chunk(file.grid(), slab, [&](const Layers& layers) {
      const LabelImage part = read_slices(file, 4 * layers.first, 4 * layers.end, num_threads(threads));
      for (const Label& label : part.labels) own.insert(label.value);
    });
  };
  do_collectively(read, ranks);
  Bytes message;
  append(message, std::vector<std::uint32_t>(own.begin(), own.end()));
  for (const Bytes& received : ranks.all_gather(std::move(message)))
    for (const std::uint32_t value : MessageReader(received).read<std::uint32_t>()) all.insert(value);
  return {all.begin(), all.end()};
}

}  // namespace

bool can_stay_in_file(const LabelSelection& selection, const MeshingOptions& options) {
  const SizeOptions& sizes = options.sizes;
  return selection.drop_islands_mm3 == 0 && selection.layers.empty() && options.smoothing_mm == 0 &&
         sizes.grade == 0 && sizes.target_elements == 0 && options.team.executor != Executor::kVirtual;
}

std::shared_ptr<const LabelImage> read_by_bricks(const std::shared_ptr<const VoxelFile>& file,
                                                 const LabelSelection& selection, int threads,
                                                 SharedValue<LabelImage>& shared, Communication& ranks) {
  expect_one_file(*file, ranks);
  const Layers own = layers_of(ranks.rank(), ranks.size(), BrickGrid(file->grid().size).size()[2]);
  const std::vector<std::uint32_t> values = values_in(*file, own, threads, ranks);
  LabelImage image = file->grid();
  std::shared_ptr<const LabelsOfValues> labels;
  Slab slab;
  const auto read = [&] {
    for (const std::uint32_t value : values) image.labels.push_back({value, {}});
    std::vector<LabelIndex> selected =
        select_among(image, selection, {values.begin(), values.end()}, file->path());
    selected.resize(values.size());
    labels = std::make_shared<const LabelsOfValues>(values, std::move(selected));
    slab = ReadSlab(*file, *labels, image.labels.size(), threads)(own);
  };
  do_collectively(read, ranks);
  const std::vector<Bytes> slabs = ranks.all_gather(message_of(slab));
  const auto make = [&] { return image_of(std::move(image), file, labels, slabs); };
  return shared.get(make, ranks);
}

}  // namespace podm
