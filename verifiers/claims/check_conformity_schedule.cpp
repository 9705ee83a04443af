#include "claims/check_conformity_schedule.h"

#include <fmt/format.h>

#include <map>
#include <tuple>
#include <utility>

#include "geometry/box_tree.h"

namespace podm::verify {

namespace {

// Corners of leaves are integers below 2^42, which doubles hold exactly.
std::vector<Bounds> cubes_of(const Schedule& schedule) {
  std::vector<Bounds> cubes;
  for (const Leaf& leaf : schedule.leaves) {
    Bounds& cube = cubes.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) {
      cube.low[a] = static_cast<double>(leaf.corner[a]);
      cube.high[a] = static_cast<double>(leaf.corner[a] + leaf.side);
    }
  }
  return cubes;
}

bool interiors_meet(const Bounds& a, const Bounds& b) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (a.low[axis] >= b.high[axis] || b.low[axis] >= a.high[axis]) return false;
  return true;
}

class LeafGrid {
 public:
  explicit LeafGrid(const Schedule& schedule) : cubes_(cubes_of(schedule)), tree_(cubes_) {}

  std::size_t size() const { return cubes_.size(); }
  bool touch(std::uint32_t a, std::uint32_t b) const { return meet(cubes_[a], cubes_[b]); }

  // Returns another leaf that overlaps this one, or kNone.
  std::uint32_t overlapping(std::uint32_t leaf) const {
    std::uint32_t found = kNone;
    tree_.for_each_near(
        [&](const Bounds& box) { return found == kNone && interiors_meet(box, cubes_[leaf]); },
        [&](std::uint32_t other) {
          if (found == kNone && other != leaf && interiors_meet(cubes_[other], cubes_[leaf])) found = other;
        });
    return found;
  }
  // Returns the leaf itself and ring 1.
  const std::vector<std::uint32_t>& around(std::uint32_t leaf) {
    const auto [place, is_new] = around_.try_emplace(leaf);
    std::vector<std::uint32_t>& leaves = place->second;
    if (is_new) {
      tree_.for_each_near([&](const Bounds& box) { return meet(box, cubes_[leaf]); },
                          [&](std::uint32_t other) {
                            if (touch(leaf, other)) leaves.push_back(other);
                          });
    }
    return leaves;
  }

 private:
  std::vector<Bounds> cubes_;
  BoxTree tree_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> around_;
};

Tally check_leaves(const LeafGrid& grid) {
  Tally tally;
  tally.num_checked = grid.size();
  for (std::uint32_t leaf = 0; leaf < grid.size(); ++leaf) {
    const std::uint32_t other = grid.overlapping(leaf);
    if (other == kNone) continue;
    tally.violation({.statement = fmt::format("leaves {} and {} do not overlap", leaf, other)});
  }
  return tally;
}

// Sweeps over time. At equal times ends come before beginnings, and instants come last.
class Sweep {
 public:
  Sweep(const Schedule& schedule, LeafGrid& grid)
      : activations_(schedule.activations),
        grid_(grid),
        active_(grid.size()),
        active_around_(grid.size()),
        seen_by_(grid.size(), kNone) {}

  Tally check() {
    for (const auto& [time, event, id] : sorted_events()) {
      const Activation& a = activations_[id];
      Active& of_leaf = active_[a.leaf];
      if (event == Event::kEnd) {
        --num_active_;
        if (--of_leaf.count > 0) continue;
        for (const std::uint32_t near : grid_.around(a.leaf)) std::erase(active_around_[near], a.leaf);
        continue;
      }
      check_beginning(id);
      if (event == Event::kInstant) continue;
      ++num_active_;
      if (of_leaf.count == 0)
        for (const std::uint32_t near : grid_.around(a.leaf)) active_around_[near].push_back(a.leaf);
      if (of_leaf.count++ == 0 || activations_[of_leaf.last].end_s < a.end_s) of_leaf.last = id;
    }
    return std::move(tally_);
  }

 private:
  enum class Event { kEnd, kBegin, kInstant };
  struct Active {
    std::uint32_t count = 0, last = kNone;  // activations of the leaf at this time; the one that ends last
  };

  std::vector<std::tuple<double, Event, std::uint32_t>> sorted_events() const {
    std::vector<std::tuple<double, Event, std::uint32_t>> events;
    for (std::uint32_t id = 0; id < activations_.size(); ++id) {
      const Activation& a = activations_[id];
      if (a.begin_s == a.end_s) {
        events.emplace_back(a.begin_s, Event::kInstant, id);
      } else {
        events.emplace_back(a.begin_s, Event::kBegin, id);
        events.emplace_back(a.end_s, Event::kEnd, id);
      }
    }
    std::sort(events.begin(), events.end());
    return events;
  }

  // Judges every pair of leaves when the later one begins.
  void check_beginning(std::uint32_t id) {
    tally_.num_checked += num_active_;
    for (const std::uint32_t near : grid_.around(activations_[id].leaf)) {
      for (const std::uint32_t other : active_around_[near]) {
        if (std::exchange(seen_by_[other], id) == id) continue;
        add_violation(activations_[id], activations_[active_[other].last]);
        tally_.num_violations += active_[other].count - 1;
      }
    }
  }

  void add_violation(const Activation& a, const Activation& before) {
    const double together_s = std::min(a.end_s, before.end_s) - a.begin_s;
    tally_.violation(
        {.statement = fmt::format("leaves {} and {}, active together from {} s on, are two rings "
                                  "apart",
                                  before.leaf, a.leaf, a.begin_s),
         .value = together_s,
         .severity = together_s});
  }

  const std::vector<Activation>& activations_;
  LeafGrid& grid_;
  std::vector<Active> active_;
  // Lists per leaf the active leaves that touch it: at most one, unless two are too near. A beginning
  // therefore checks its first ring alone, however many small leaves touch a large leaf there.
  std::vector<std::vector<std::uint32_t>> active_around_;
  std::vector<std::uint32_t> seen_by_;  // by leaf: the last activation whose two rings held it
  std::uint64_t num_active_ = 0;
  Tally tally_;
};

Tally check_touched_leaves(const Schedule& schedule, const LeafGrid& grid) {
  Tally tally;
  for (const Activation& a : schedule.activations) {
    for (const std::uint32_t touched : a.touched_leaves) {
      ++tally.num_checked;
      if (grid.touch(a.leaf, touched)) continue;
      tally.violation({.statement = fmt::format("operations of leaf {} from {} s on keep to it and its first "
                                                "ring, not to {}",
                                                a.leaf, a.begin_s, touched)});
    }
  }
  return tally;
}

}  // namespace

void check_schedule(const Schedule& schedule, const std::function<void(const char*, const Tally&)>& add) {
  LeafGrid grid(schedule);
  const Tally leaves = check_leaves(grid);
  add("overlapping_leaves", leaves);
  add("leaves_touched_outside", check_touched_leaves(schedule, grid));
  // Leaves are disjoint cubes, and each touches a bounded number of leaves that are no smaller. All first
  // rings together are therefore linear in the leaves.
  if (leaves.num_violations == 0) add("active_leaves_too_near", Sweep(schedule, grid).check());
}

}  // namespace podm::verify
