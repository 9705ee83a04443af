#include "lines/trace_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "image/working_frame.h"
#include "lines/block_grid.h"
#include "lines/line_graph.h"
#include "lines/polyline.h"
#include "lines/trace_block.h"
#include "lines/trace_square.h"
#include "podm/errors.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

// Tasks of some rows of blocks: enough work for one task, and many tasks for all threads.
constexpr int kRowsOfTask = 8;

// Estimated bytes by the number of labels in a block, and per square on a side: pieces, their points and
// joints, twice while they are joined. Measured on noise, where blocks have most pieces.
constexpr std::array<std::uint64_t, 9> kBytesOfBlock{0, 0, 0, 700, 2000, 4000, 6500, 10000, 14000};
constexpr std::uint64_t kBytesOfSquare = 1500;
constexpr std::uint64_t kBytesOfThread = 1 << 20;

class LineTracer {
 public:
  LineTracer(const LabelImage& image, const VoxelWeights* weights, const LineOptions& options)
      : grid_(image, weights, options.is_box_flat),
        options_(options),
        threads_(num_threads(options.threads)),
        to_mm_(voxels_to_working(image)) {}

  std::uint64_t memory() const;
  LineNetwork operator()();

 private:
  bool is_over() const { return options_.is_over && options_.is_over(); }
  std::uint64_t num_squares_with_curves() const;
  template <class Work>
  void for_each_task(const Work& work) const;
  void trace_blocks();
  void trace_sides();
  void drop_decided(const LineGraph& graph);
  void list_removed(const std::vector<Point>& points);
  LineNetwork network(LineGraph& graph);

  BlockGrid grid_;
  const LineOptions& options_;
  std::size_t threads_;
  Affine to_mm_;
  std::vector<Pieces> parts_;
  std::vector<UndecidedPlace> undecided_;
  double removed_voxels_ = 0;
};

// Calls work(task, thread, j begin, j end, k) for rows of blocks (j,k), until tracing is over.
template <class Work>
void LineTracer::for_each_task(const Work& work) const {
  const int num_j = grid_.size(1) + 1, tasks_of_layer = (num_j + kRowsOfTask - 1) / kRowsOfTask;
  const auto num_tasks =
      static_cast<std::size_t>(tasks_of_layer) * static_cast<std::size_t>(grid_.size(2) + 1);
  parallel_for(num_tasks, threads_, [&](std::size_t task, std::size_t thread) {
    if (is_over()) return;
    const int k = static_cast<int>(task / static_cast<std::size_t>(tasks_of_layer)) - 1;
    const int begin = static_cast<int>(task % static_cast<std::size_t>(tasks_of_layer)) * kRowsOfTask - 1;
    work(task, thread, begin, std::min(begin + kRowsOfTask, num_j - 1), k);
  });
}

std::uint64_t LineTracer::memory() const {
  std::uint64_t bytes = 0;
  if (options_.has_lines) {
    std::vector<std::uint64_t> of_threads(threads_);
    std::vector<BlockGrid::RowScratch> scratch(threads_);
    for_each_task([&](std::size_t, std::size_t thread, int begin, int end, int k) {
      std::vector<int> blocks;
      for (int j = begin; j < end; ++j) {
        blocks.clear();
        grid_.find_blocks(j, k, scratch[thread], blocks);
        for (const int i : blocks)
          of_threads[thread] += kBytesOfBlock[WeightForms(grid_.corners({i, j, k})).size()];
      }
    });
    for (const std::uint64_t b : of_threads) bytes += b;
    bytes += threads_ * kBytesOfThread;
  }
  return options_.is_box_flat ? bytes + kBytesOfSquare * num_squares_with_curves() : bytes;
}

std::uint64_t LineTracer::num_squares_with_curves() const {
  std::uint64_t count = 0;
  for (const BoxSide& side : kBoxSides)
    for (int q = -1; q < grid_.size(side.v()); ++q)
      for (int p = -1; p < grid_.size(side.u()); ++p) {
        const BlockCorners corners = corners_of_square(grid_, side, p, q);
        count += std::any_of(corners.labels.begin(), corners.labels.end(),
                             [&](LabelIndex label) { return label != corners.labels[0]; });
      }
  return count;
}

void LineTracer::trace_blocks() {
  std::vector<std::unique_ptr<BlockTracer>> tracers(threads_);
  std::vector<BlockGrid::RowScratch> scratch(threads_);
  const int num_j = grid_.size(1) + 1, tasks_of_layer = (num_j + kRowsOfTask - 1) / kRowsOfTask;
  parts_.resize(static_cast<std::size_t>(tasks_of_layer) * static_cast<std::size_t>(grid_.size(2) + 1));
  for_each_task([&](std::size_t task, std::size_t thread, int begin, int end, int k) {
    if (!tracers[thread]) tracers[thread] = std::make_unique<BlockTracer>(grid_, options_.counts);
    std::vector<int> blocks;
    for (int j = begin; j < end; ++j) {
      blocks.clear();
      grid_.find_blocks(j, k, scratch[thread], blocks);
      for (const int i : blocks) tracers[thread]->trace({i, j, k}, parts_[task]);
    }
  });
}

// A task is a row of squares of one side.
void LineTracer::trace_sides() {
  struct Row {
    BoxSide side;
    int q;
  };
  std::vector<Row> rows;
  for (const BoxSide& side : kBoxSides)
    for (int q = -1; q < grid_.size(side.v()); ++q) rows.push_back({side, q});
  const std::size_t first = parts_.size();
  parts_.resize(first + rows.size() + 1);
  std::vector<std::unique_ptr<SquareTracer>> tracers(threads_);
  parallel_for(rows.size(), threads_, [&](std::size_t r, std::size_t thread) {
    if (is_over()) return;
    if (!tracers[thread]) tracers[thread] = std::make_unique<SquareTracer>(grid_);
    const auto& [side, q] = rows[r];
    for (int p = -1; p < grid_.size(side.u()); ++p) tracers[thread]->trace(side, p, q, parts_[first + r]);
  });
  trace_box_edges(grid_, parts_.back());
}

Voxel block_at(const Point& p) {
  return {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
          static_cast<int>(std::floor(p.z))};
}

auto order_of(const Voxel& v) { return std::tuple(v.k, v.j, v.i); }

// The segments of a network by the blocks that they may be near to.
class SegmentMap {
 public:
  SegmentMap(const LineGraph& graph, const std::vector<UndecidedPlace>& places) {
    for (const UndecidedPlace& place : places) segments_[order_of(block_at(place.point))];
    for (const GraphArc& arc : graph.arcs)
      for (std::size_t i = 0; i + 1 < arc.points.size(); ++i) add(arc.points[i], arc.points[i + 1]);
  }
  /// True if a segment is within `distance`, at most kFoundDistance, of one of the places.
  bool is_near(const UndecidedPlace& place, double distance) const {
    const auto found = segments_.find(order_of(block_at(place.point)));
    return std::any_of(found->second.begin(), found->second.end(), [&](const auto& segment) {
      return nearest_on(segment, place.point).distance <= distance;
    });
  }

 private:
  void add(const Point& a, const Point& b) {
    const Voxel low = block_at({std::min(a.x, b.x) - kFoundDistance, std::min(a.y, b.y) - kFoundDistance,
                                std::min(a.z, b.z) - kFoundDistance});
    const Voxel high = block_at({std::max(a.x, b.x) + kFoundDistance, std::max(a.y, b.y) + kFoundDistance,
                                 std::max(a.z, b.z) + kFoundDistance});
    for (int k = low.k; k <= high.k; ++k)
      for (int j = low.j; j <= high.j; ++j)
        for (int i = low.i; i <= high.i; ++i)
          if (const auto found = segments_.find(order_of({i, j, k})); found != segments_.end())
            found->second.push_back({a, b});
  }

  std::map<std::tuple<int, int, int>, std::vector<std::array<Point, 2>>> segments_;
};

// A tracer of one block does not know of curves in the next, to which a place may be near. It does not know
// either if a curve that it cannot confirm will be removed.
void LineTracer::drop_decided(const LineGraph& graph) {
  const SegmentMap segments(graph, undecided_);
  using enum UndecidedPlace::Reason;
  std::erase_if(undecided_, [&](const UndecidedPlace& place) {
    return (place.reason == kMissed && segments.is_near(place, kFoundDistance)) ||
           (place.reason == kUnconfirmed && !segments.is_near(place, kMergeDistance));
  });
}

void LineTracer::list_removed(const std::vector<Point>& points) {
  for (const Point& p : points) undecided_.push_back({block_at(p), p, UndecidedPlace::Reason::kTooSmall});
}

LineNetwork ended_early() {
  LineNetwork network;
  network.is_whole = false;
  return network;
}

// Converts the graph; nodes without arcs are left out.
LineNetwork LineTracer::network(LineGraph& graph) {
  LineNetwork network;
  std::vector<std::int32_t> number(graph.nodes.size(), -1);
  for (GraphArc& arc : graph.arcs) {
    for (Point& p : arc.points) p = map(to_mm_, p);
    for (std::int32_t& end : arc.ends) {
      if (end < 0) continue;
      GraphNode& node = graph.nodes[static_cast<std::size_t>(end)];
      std::int32_t& n = number[static_cast<std::size_t>(end)];
      if (n < 0) {
        n = static_cast<std::int32_t>(network.nodes.size());
        network.nodes.push_back({map(to_mm_, node.point), node.sides, std::move(node.labels)});
      }
      end = n;
    }
    network.arcs.push_back(
        {std::move(arc.points), arc.ends[0], arc.ends[1], std::move(arc.labels), arc.sides});
  }
  const auto order = [](const UndecidedPlace& u) { return std::tuple(order_of(u.block), u.reason); };
  std::stable_sort(undecided_.begin(), undecided_.end(),
                   [&](const auto& a, const auto& b) { return order(a) < order(b); });
  const auto end = std::unique(undecided_.begin(), undecided_.end(),
                               [&](const auto& a, const auto& b) { return order(a) == order(b); });
  undecided_.erase(end, undecided_.end());
  for (UndecidedPlace& u : undecided_) u.point = map(to_mm_, u.point);
  network.undecided = std::move(undecided_);
  network.removed_voxels = removed_voxels_;
  return network;
}

LineNetwork LineTracer::operator()() {
  if (options_.has_lines) trace_blocks();
  if (options_.is_box_flat) trace_sides();
  if (is_over()) return ended_early();
  for (const Pieces& part : parts_) {
    undecided_.insert(undecided_.end(), part.undecided.begin(), part.undecided.end());
    removed_voxels_ += part.removed_voxels;
  }
  LineGraph graph = join_pieces(parts_, threads_);
  const RemovedCurves removed = simplify(graph, options_.has_lines);
  drop_decided(graph);
  list_removed(removed.points);
  removed_voxels_ += removed.length_voxels;
  return network(graph);
}

}  // namespace

std::uint64_t memory_of_lines(const LabelImage& image, const LineOptions& options) {
  return LineTracer(image, nullptr, options).memory();
}

LineNetwork trace_lines(const LabelImage& image, const VoxelWeights* weights, const LineOptions& options) {
  if (image.voxels.empty()) throw InternalError("lines are traced only in images that hold their voxels");
  if (options.is_box_flat && is_sheared(image))
    throw InputError(
        "a sheared image cannot have a flat box: no plane of the image is one of the mesh's frame");
  LineTracer tracer(image, weights, options);
  if (options.most_bytes != std::numeric_limits<std::uint64_t>::max()) {
    const std::uint64_t bytes = tracer.memory();
    if (bytes > options.most_bytes)
      throw InputError(
          fmt::format("the lines of the image need about {} MB of memory, above the limit of {} MB",
                      bytes >> 20, options.most_bytes >> 20));
  }
  return tracer();
}

}  // namespace podm
