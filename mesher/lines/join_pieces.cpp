#include <algorithm>
#include <bit>
#include <span>

#include "lines/line_graph.h"
#include "podm/errors.h"
#include "runtime/parallel_for.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

class Joiner {
 public:
  Joiner(std::vector<Pieces>& parts, std::size_t threads) {
    gather(parts);
    parallel_sort(joints_.begin(), joints_.end(), threads,
                  [](const Joint& a, const Joint& b) { return a.key < b.key; });
    find_ends(threads);
  }

  LineGraph operator()() {
    is_walked_.assign(pieces_.size(), false);
    node_of_joint_.assign(joints_.size(), -1);
    // Ends of pieces at nodes come first: what is left then is closed.
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      for (std::size_t e = 0; e < 2 && !pieces_[p].is_closed; ++e)
        if (!is_walked_[p] && !goes_on(joint(p, e))) walk(p, e);
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      if (!is_walked_[p]) walk(p, 0);
    return std::move(graph_);
  }

 private:
  void gather(std::vector<Pieces>& parts);
  void find_ends(std::size_t threads);
  std::size_t joint(std::size_t piece, std::size_t end) const { return joint_of_end_[2 * piece + end]; }
  std::span<const Point> points(std::size_t piece) const {
    return {points_.data() + first_point_[piece], pieces_[piece].num_points};
  }
  std::span<const std::size_t> ends_at(std::size_t joint) const {
    return {ends_.data() + first_end_[joint], ends_.data() + first_end_[joint + 1]};
  }
  bool goes_on(std::size_t joint) const;
  void walk(std::size_t piece, std::size_t end);
  void append(GraphArc& arc, std::size_t piece, std::size_t from) const;
  std::int32_t node(std::size_t joint);

  std::vector<Piece> pieces_;
  std::vector<Point> points_;
  std::vector<Joint> joints_;
  std::vector<std::size_t> first_point_;   // by piece
  std::vector<std::size_t> joint_of_end_;  // by 2 * piece + end
  std::vector<std::size_t> first_end_;     // by joint, and one past the last
  std::vector<std::size_t> ends_;          // 2 * piece + end, by joint
  std::vector<bool> is_walked_;
  std::vector<std::int32_t> node_of_joint_;
  LineGraph graph_;
};

void Joiner::gather(std::vector<Pieces>& parts) {
  std::size_t num_pieces = 0, num_points = 0, num_joints = 0;
  for (const Pieces& part : parts) {
    num_pieces += part.pieces.size();
    num_points += part.points.size();
    num_joints += part.joints.size();
  }
  pieces_.reserve(num_pieces);
  points_.reserve(num_points);
  joints_.reserve(num_joints);
  for (Pieces& part : parts) {
    pieces_.insert(pieces_.end(), part.pieces.begin(), part.pieces.end());
    points_.insert(points_.end(), part.points.begin(), part.points.end());
    joints_.insert(joints_.end(), part.joints.begin(), part.joints.end());
    part = {};
  }
  parts.clear();
}

void Joiner::find_ends(std::size_t threads) {
  first_point_.reserve(pieces_.size());
  std::size_t next = 0;
  for (const Piece& piece : pieces_) {
    first_point_.push_back(next);
    next += piece.num_points;
  }
  joint_of_end_.resize(2 * pieces_.size());
  parallel_for_ranges(pieces_.size(), 1 << 12, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t p = begin; p < end; ++p) {
      for (std::size_t e = 0; e < 2 && !pieces_[p].is_closed; ++e) {
        const JointKey key = pieces_[p].ends[e];
        const auto found = std::lower_bound(joints_.begin(), joints_.end(), key,
                                            [](const Joint& joint, JointKey k) { return joint.key < k; });
        if (found == joints_.end() || found->key != key)
          throw InternalError("a piece of a line ends at no joint");
        joint_of_end_[2 * p + e] = static_cast<std::size_t>(found - joints_.begin());
      }
    }
  });
  first_end_.assign(joints_.size() + 1, 0);
  const auto for_each_end = [&](const auto& visit) {
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      for (std::size_t e = 0; e < 2 && !pieces_[p].is_closed; ++e) visit(joint(p, e), 2 * p + e);
  };
  for_each_end([&](std::size_t joint, std::size_t) { ++first_end_[joint + 1]; });
  for (std::size_t j = 0; j < joints_.size(); ++j) first_end_[j + 1] += first_end_[j];
  ends_.resize(first_end_.back());
  std::vector<std::size_t> at(first_end_.begin(), first_end_.end() - 1);
  for_each_end([&](std::size_t joint, std::size_t end) { ends_[at[joint]++] = end; });
}

bool Joiner::goes_on(std::size_t joint) const {
  const auto ends = ends_at(joint);
  if (ends.size() != 2) return false;
  const Piece &a = pieces_[ends[0] / 2], &b = pieces_[ends[1] / 2];
  return a.labels == b.labels && a.sides == b.sides && a.sides == joints_[joint].sides;
}

std::int32_t Joiner::node(std::size_t joint) {
  if (node_of_joint_[joint] < 0) {
    node_of_joint_[joint] = static_cast<std::int32_t>(graph_.nodes.size());
    graph_.nodes.push_back({joints_[joint].point, joints_[joint].sides, joints_[joint].labels.list()});
  }
  return node_of_joint_[joint];
}

// Appends the points of a piece from one of its ends to the other, without the first if the arc has it.
void Joiner::append(GraphArc& arc, std::size_t piece, std::size_t from) const {
  const std::span<const Point> own = points(piece);
  for (std::size_t i = arc.points.empty() ? 0 : 1; i < own.size(); ++i)
    arc.points.push_back(from == 0 ? own[i] : own[own.size() - 1 - i]);
}

// Makes the arc that begins with a piece's end.
void Joiner::walk(std::size_t piece, std::size_t end) {
  GraphArc arc;
  arc.sides = pieces_[piece].sides;
  arc.labels = pieces_[piece].labels.list();
  if (!pieces_[piece].is_closed && !goes_on(joint(piece, end))) arc.ends[0] = node(joint(piece, end));
  while (true) {
    is_walked_[piece] = true;
    append(arc, piece, end);
    if (pieces_[piece].is_closed) break;
    const std::size_t last = joint(piece, 1 - end);
    if (!goes_on(last)) {
      arc.ends[1] = node(last);
      break;
    }
    const auto ends = ends_at(last);
    const std::size_t next = ends[0] == 2 * piece + 1 - end ? ends[1] : ends[0];
    if (is_walked_[next / 2]) break;
    piece = next / 2;
    end = next % 2;
  }
  if (arc.is_closed())
    arc.points.back() = arc.points.front();
  else {
    arc.points.front() = graph_.nodes[static_cast<std::size_t>(arc.ends[0])].point;
    arc.points.back() = graph_.nodes[static_cast<std::size_t>(arc.ends[1])].point;
  }
  graph_.arcs.push_back(std::move(arc));
}

}  // namespace

LineGraph join_pieces(std::vector<Pieces>& parts, std::size_t threads) { return Joiner(parts, threads)(); }

}  // namespace podm
