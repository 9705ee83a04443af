#include "image/merge_layers.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "image/label_selection.h"
#include "image/segments.h"
#include "podm/option.h"
#include "runtime/parallel_for.h"
#include "runtime/parallel_resize.h"

namespace podm {
namespace {

constexpr std::size_t kChunk = 1 << 18;  // voxels
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

LayerOrder all_layers(std::size_t num_layers) {
  LayerOrder order(num_layers);
  for (std::size_t i = 0; i < num_layers; ++i) order[i] = i;
  return order;
}

// A rank per segment: at a voxel the segment of the highest rank is the topmost. Only segments of one layer,
// which never meet, share a rank.
std::vector<std::size_t> ranks_of(const std::vector<Segment>& segments, const LabelSelection& selection) {
  std::vector<std::size_t> ranks;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const LayerOrder& layers = selection.layers;
    const auto place = std::find(layers.begin(), layers.end(), segments[i].layer) - layers.begin();
    const std::size_t rank = layers.empty() ? i : static_cast<std::size_t>(place);
    const std::size_t above_all = std::max(segments.size(), layers.size());
    ranks.push_back(rank + (is_kept(selection, segments[i].label.value) ? above_all : 0));
  }
  return ranks;
}

struct SegmentCounts {
  std::uint64_t voxels = 0, covered = 0;
};

// Finds the segment of a value in a layer. Values come in runs, therefore the last one is remembered.
template <class Voxel>
class SegmentFinder {
 public:
  SegmentFinder(const std::vector<Segment>& segments, std::size_t layer) {
    for (std::size_t i = 0; i < segments.size(); ++i)
      if (segments[i].layer == layer) segment_of_[segments[i].stored_value] = i;
  }

  // kNone if there is none.
  std::size_t operator()(Voxel value) {
    if (last_ != value) {
      last_ = value;
      const auto found =
          is_value(value) ? segment_of_.find(static_cast<std::uint32_t>(value)) : segment_of_.end();
      last_segment_ = found == segment_of_.end() ? kNone : found->second;
    }
    return last_segment_;
  }

 private:
  static bool is_value(Voxel value) {
    constexpr double kEnd = 4294967296.0;
    const auto number = static_cast<double>(value);
    return number > 0 && number < kEnd && static_cast<Voxel>(static_cast<std::uint32_t>(number)) == value;
  }

  std::map<std::uint32_t, std::size_t> segment_of_;
  std::optional<Voxel> last_;
  std::size_t last_segment_ = kNone;
};

// Merges ranges of voxels, one thread at a time.
template <class Voxel>
class Merger {
 public:
  Merger(const RawImage& raw, const LayerOrder& order, const std::vector<std::size_t>& ranks)
      : raw_(raw), order_(order), ranks_(ranks), counts_(raw.segments.size()) {
    for (const std::size_t layer : order) finders_.emplace_back(raw.segments, layer);
  }

  template <class Merged>
  void merge(std::size_t begin, std::size_t end, Merged* merged) {
    for (std::size_t voxel = begin; voxel < end; ++voxel) {
      const std::size_t top = topmost(voxel);
      merged[voxel] = top == kNone ? Merged{0} : static_cast<Merged>(raw_.segments[top].label.value);
    }
  }

  const std::vector<SegmentCounts>& counts() const { return counts_; }
  // The first voxel of this thread with a value of no segment, and its layer.
  const std::optional<std::pair<std::size_t, std::size_t>>& stray() const { return stray_; }

 private:
  std::size_t topmost(std::size_t voxel) {
    const unsigned char* const values = raw_.bytes.data() + voxel * raw_.num_layers * sizeof(Voxel);
    std::size_t top = kNone;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      Voxel value;
      std::memcpy(&value, values + order_[i] * sizeof(Voxel), sizeof value);
      if (value == Voxel{0}) continue;
      const std::size_t segment = finders_[i](value);
      if (segment == kNone) {
        if (!stray_ || voxel < stray_->first) stray_ = {voxel, order_[i]};
        continue;
      }
      ++counts_[segment].voxels;
      const bool is_above = top == kNone || ranks_[segment] > ranks_[top];
      if (const std::size_t below = is_above ? top : segment; below != kNone) ++counts_[below].covered;
      if (is_above) top = segment;
    }
    return top;
  }

  const RawImage& raw_;
  const LayerOrder& order_;
  const std::vector<std::size_t>& ranks_;
  std::vector<SegmentFinder<Voxel>> finders_;  // by position in the order
  std::vector<SegmentCounts> counts_;
  std::optional<std::pair<std::size_t, std::size_t>> stray_;
};

template <class Voxel>
[[noreturn]] void refuse_stray(const RawImage& raw, std::size_t voxel, std::size_t layer) {
  Voxel value;
  std::memcpy(&value, raw.bytes.data() + (voxel * raw.num_layers + layer) * sizeof(Voxel), sizeof value);
  const auto x = static_cast<std::size_t>(raw.size[0]), y = static_cast<std::size_t>(raw.size[1]);
  refuse(raw.path, "voxel (" + std::to_string(voxel % x) + ", " + std::to_string(voxel / x % y) + ", " +
                       std::to_string(voxel / x / y) + ") of layer " + std::to_string(layer) + " is " +
                       std::to_string(value) + ", the label value of no segment in this layer");
}

template <class Voxel, class Merged>
void merge_into(RawImage& raw, const LayerOrder& order, const std::vector<std::size_t>& ranks,
                std::size_t threads, std::vector<unsigned char>& bytes) {
  const std::size_t num_voxels = checked_num_voxels(raw.path, raw.size);
  parallel_resize(bytes, num_voxels * sizeof(Merged), threads);
  auto* const merged = reinterpret_cast<Merged*>(bytes.data());
  std::vector<Merger<Voxel>> mergers(threads, Merger<Voxel>(raw, order, ranks));
  parallel_for_ranges(num_voxels, kChunk, threads,
                      [&](std::size_t begin, std::size_t end, std::size_t thread) {
                        mergers[thread].merge(begin, end, merged);
                      });
  std::optional<std::pair<std::size_t, std::size_t>> stray;
  for (const Merger<Voxel>& merger : mergers) {
    if (merger.stray() && (!stray || *merger.stray() < *stray)) stray = merger.stray();
    for (std::size_t i = 0; i < raw.segments.size(); ++i) {
      raw.segments[i].voxels += merger.counts()[i].voxels;
      raw.segments[i].covered += merger.counts()[i].covered;
    }
  }
  if (stray) refuse_stray<Voxel>(raw, stray->first, stray->second);
}

void warn_of_cover(RawImage& raw, const LabelSelection& selection) {
  for (std::size_t i = 0; i < raw.segments.size(); ++i) {
    const Segment& segment = raw.segments[i];
    if (segment.covered == 0 || !is_kept(selection, segment.label.value)) continue;
    const bool is_whole = segment.covered == segment.voxels;
    raw.warnings.push_back(raw.path + ": " +
                           (is_whole ? "all " : std::to_string(segment.covered) + " of the ") +
                           std::to_string(segment.voxels) + " voxels of " + text_of_segment(raw.segments, i) +
                           " (layer " + std::to_string(segment.layer) + ") belong to segments above it" +
                           (is_whole ? ", so the image has no such label; " : "; ") + spelled("layers") +
                           " sets the order of layers");
  }
}

void warn_of_numbers(RawImage& raw) {
  if (!are_renumbered(raw.segments)) return;
  constexpr std::size_t kMostListed = 20;
  std::string list;
  for (std::size_t i = 0; i < std::min(raw.segments.size(), kMostListed); ++i)
    list +=
        (i == 0 ? "" : ", ") + std::to_string(raw.segments[i].label.value) + " " + raw.segments[i].label.name;
  if (raw.segments.size() > kMostListed) list += " ...";
  raw.warnings.push_back(raw.path +
                         ": segments of different layers share label values, therefore labels are " +
                         "numbered in the order of segments: " + list);
}

}  // namespace

void check_layers(const std::string& path, const LabelSelection& selection, std::size_t num_segments,
                  std::size_t num_layers) {
  const std::string option = spelled("layers");
  if (!selection.layers.empty() && num_segments == 0)
    refuse(path, option + ": the image has no layers (a segmentation of 3D Slicer, .seg.nrrd, has them)");
  for (const std::size_t layer : selection.layers)
    if (layer >= num_layers)
      refuse(path, option + ": layer " + std::to_string(layer) +
                       " is not in the image, whose layers are 0 to " + std::to_string(num_layers - 1));
}

void merge_layers(RawImage& raw, const LabelSelection& selection, std::size_t threads) {
  if (raw.num_layers == 1) return;
  const LayerOrder order = selection.layers.empty() ? all_layers(raw.num_layers) : selection.layers;
  const std::vector<std::size_t> ranks = ranks_of(raw.segments, selection);
  std::uint32_t largest = 0;
  for (const Segment& segment : raw.segments) largest = std::max(largest, segment.label.value);
  const bool is_small = largest <= std::numeric_limits<std::uint16_t>::max();
  std::vector<unsigned char> merged;
  with_voxel_type(raw.type, [&]<class Voxel>(Voxel) {
    if (is_small) {
      merge_into<Voxel, std::uint16_t>(raw, order, ranks, threads, merged);
    } else {
      merge_into<Voxel, std::uint32_t>(raw, order, ranks, threads, merged);
    }
  });
  raw.bytes = std::move(merged);
  raw.type = is_small ? VoxelType::kUint16 : VoxelType::kUint32;
  raw.num_layers = 1;
  warn_of_numbers(raw);
  warn_of_cover(raw, selection);
}

}  // namespace podm
