// Measures how busy each order keeps the nodes, and how much of their work is near their earlier work.
// Simulates a ball of 2176 leaves, each of which takes from 0.5 to 1.5 units of time at first. A finished
// leaf gives its first ring a fifth of its work.
//
//               8 nodes               16 nodes              32 nodes              64 nodes
//               busy   own    visits  busy   own    visits  busy   own    visits  busy   own    visits
//   home        0.998  0.790  2.28    0.996  0.682  2.33    0.964  0.584  2.72    0.676  0.488  3.95
//   most work   1.000  0.146  2.19    1.000  0.095  2.20    0.976  0.069  2.29    0.688  0.030  3.77
//   Morton      0.976  0.655  3.18    0.964  0.433  3.68    0.898  0.237  4.21    0.701  0.037  5.09
//   coloring    1.000  0.124  2.34    1.000  0.065  2.39    0.982  0.032  2.73    0.689  0.024  4.87
//
// busy: share of the time at work; own: share of the first ring, weighted by work, that the node itself was
// the last to refine; visits: activations per leaf. At most about 80 of these leaves can be active at once.
// Home is nearly as busy as any other order. It does most of its work where it worked before, with few
// visits. From 64 nodes on no order keeps the nodes busy: there are too few leaves.
#include <gtest/gtest.h>

#include <map>
#include <queue>
#include <random>

#include "octree/refinement_queue.h"
#include "refinement_queue_state.h"

namespace podm::test {
namespace {

constexpr unsigned kWork = 1000;
constexpr std::pair<LeafOrder, const char*> kNamedOrders[] = {{LeafOrder::kHome, "home"},
                                                              {LeafOrder::kMostWork, "most work"},
                                                              {LeafOrder::kMorton, "Morton"},
                                                              {LeafOrder::kColoring, "coloring"}};

Octree ball(double diameter) {
  const Point center{diameter / 2, diameter / 2, diameter / 2};
  return {{0, 0, 0},
          {diameter, diameter, diameter},
          1,
          [](const Point&, const Point&) { return 1.0; },
          [=](const Point& low, const Point& high) {
            return distance(0.5 * (low + high), center) < diameter / 2;
          }};
}

struct Figures {
  double busy = 0, own = 0, visits = 0;
};

class Simulation {
 public:
  Simulation(const Octree& octree, unsigned num_nodes, LeafOrder order)
      : octree_(octree),
        num_nodes_(num_nodes),
        queue_(octree, num_nodes, order),
        poor_of_(octree.num_leaves()),
        last_node_(octree.num_leaves(), num_nodes) {
    queue_.share_out();
    std::mt19937_64 random(1);
    for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf)
      give(leaf, kWork / 2 + static_cast<unsigned>(random() % kWork));
    for (unsigned node = 0; node < num_nodes; ++node) idle_.push_back(node);
  }

  Figures run() {
    for (begin_all(); !running_.empty(); begin_all()) {
      const Run run = running_.top();
      running_.pop();
      now_ = run.end;
      const unsigned share = run.work / 5 / 26;
      for (const LeafId near : octree_.first_ring(run.leaf)) give(near, share);
      queue_.finish(run.leaf);
      idle_.push_back(run.node);
    }
    return {double(work_) / double(now_ * num_nodes_), double(own_) / double(near_),
            double(visits_) / octree_.num_leaves()};
  }

 private:
  struct Run {
    std::uint64_t end;
    unsigned node, work;
    LeafId leaf;
    bool operator<(const Run& other) const { return std::tie(end, node) > std::tie(other.end, other.node); }
  };

  void give(LeafId leaf, unsigned num_poor) {
    poor_of_[leaf] += num_poor;
    queue_.push(leaf, num_poor);
  }
  void begin_all() {
    std::erase_if(idle_, [&](unsigned node) {
      const std::optional<LeafId> leaf = pop(queue_, node);
      if (leaf) begin(node, *leaf);
      return leaf.has_value();
    });
  }
  void begin(unsigned node, LeafId leaf) {
    const unsigned work = std::exchange(poor_of_[leaf], 0);
    running_.push({now_ + work, node, work, leaf});
    for (const LeafId near : octree_.first_ring(leaf)) {
      if (last_node_[near] < num_nodes_) near_ += work;
      if (last_node_[near] == node) own_ += work;
    }
    last_node_[leaf] = node;
    work_ += work;
    ++visits_;
  }

  const Octree& octree_;
  unsigned num_nodes_;
  RefinementQueue queue_;
  std::vector<unsigned> poor_of_, last_node_;
  std::vector<unsigned> idle_;
  std::priority_queue<Run> running_;
  std::uint64_t now_ = 0, work_ = 0, own_ = 0, near_ = 0, visits_ = 0;
};

class Orders : public testing::TestWithParam<unsigned> {};

TEST_P(Orders, HomeKeepsNodesBusyAndNear) {
  const Octree octree = ball(16);
  const unsigned num_nodes = GetParam();
  const unsigned num_together = octree.num_leaves() / 27;
  std::map<LeafOrder, Figures> figures;
  for (const auto& [order, name] : kNamedOrders) {
    const Figures& f = figures[order] = Simulation(octree, num_nodes, order).run();
    RecordProperty(name, testing::PrintToString(std::vector{f.busy, f.own, f.visits}));
  }
  const Figures& home = figures[LeafOrder::kHome];
  for (const auto& [order, f] : figures) {
    EXPECT_GT(home.busy, 0.95 * f.busy);
    EXPECT_TRUE(num_nodes > num_together / 2 || home.own > 0.99 * f.own);
  }
  EXPECT_TRUE(num_nodes > num_together / 5 || home.busy > 0.95);
}

INSTANTIATE_TEST_SUITE_P(Nodes, Orders, testing::Values(8, 16, 32, 64));

}  // namespace
}  // namespace podm::test
