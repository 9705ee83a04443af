#include "distributed/vertex_histories.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "podm/errors.h"

namespace podm {

namespace {

using What = VertexEvent::What;

[[noreturn]] void fail(const Point& p, const std::string& fault) {
  throw InputError(fmt::format("the logs contradict each other about the vertex at ({}, {}, {}): {}", p.x,
                               p.y, p.z, fault));
}

}  // namespace

std::vector<VertexEvent> events_of(const OperationLog& log) {
  std::vector<VertexEvent> events;
  events.reserve(log.all.operations.size() + log.all.removed.size());
  std::unordered_map<std::uint32_t, Point> point_of;  // by vertex number in the log
  const std::uint32_t* removed = log.all.removed.data();
  for (const LoggedOperation& logged : log.all.operations) {
    const Point p{logged.point[0], logged.point[1], logged.point[2]};
    const bool is_move = logged.kind == kMovedVertex, is_forgotten = logged.kind == kReceivedRemoval;
    for (std::uint32_t i = 0; i < logged.num_removed; ++i) {
      const auto gone = point_of.extract(*removed++);
      if (!is_move)
        events.push_back(
            {gone.mapped(), logged.sequence, is_forgotten ? What::kForgotten : What::kRemoved, 0});
    }
    if (is_forgotten) continue;
    point_of.emplace(logged.vertex, p);
    if (is_move) continue;
    const What what = logged.kind >= kSeed                ? What::kSeeded
                      : logged.kind >= kReceivedInsertion ? What::kLearnt
                                                          : What::kInserted;
    events.push_back({p, logged.sequence, what, logged.kind % kReceivedInsertion});
  }
  return events;
}

void VertexHistories::add(int rank, const std::vector<VertexEvent>& events,
                          const std::vector<CubesOfRank::Run>& known) {
  for (const VertexEvent& event : events) {
    if (!block_.has(event.point)) throw InternalError("an event outside of the block");
    events_.push_back({event, rank});
  }
  for (const auto& [first, last] : known)
    for (std::uint64_t cube = first; cube <= last; ++cube)
      if (block_.has(static_cast<CubeId>(cube))) ranks_that_know_[static_cast<CubeId>(cube)].push_back(rank);
}

void VertexHistories::check() {
  std::sort(events_.begin(), events_.end(), [](const OfRank& a, const OfRank& b) {
    if (a.event.point != b.event.point) return lexicographically_less(a.event.point, b.event.point);
    const std::uint64_t step = step_of(a.event.sequence), other = step_of(b.event.sequence);
    return std::tie(step, a.rank, a.event.sequence) < std::tie(other, b.rank, b.event.sequence);
  });
  for (auto begin = events_.cbegin(); begin != events_.cend();) {
    const Point p = begin->event.point;
    Vertex vertex;
    auto end = begin;
    for (; end != events_.cend() && end->event.point == p; begin = end) {
      const std::uint64_t step = step_of(begin->event.sequence);
      while (end != events_.cend() && end->event.point == p && step_of(end->event.sequence) == step) ++end;
      follow(begin, end, vertex);
    }
    check_end(p, vertex);
  }
}

// Follows the events of one step. Ranks learn what was before the step.
void VertexHistories::follow(Events begin, Events end, Vertex& vertex) {
  const Vertex before = vertex;
  const std::uint64_t step = step_of(begin->event.sequence);
  int writer = -1;
  for (auto it = begin; it != end; ++it) {
    const auto& [event, rank] = *it;
    const auto expect = [&, rank = rank](bool holds, const char* fault) {
      if (!holds) fail(event.point, fmt::format("in step {} rank {} {}", step, rank, fault));
    };
    const bool is_change = event.what == What::kInserted || event.what == What::kRemoved;
    if (is_change) {
      expect(writer == -1 || writer == rank, "changes it, and another rank does, too");
      writer = rank;
    }
    switch (event.what) {
      case What::kSeeded:
        expect(step == 0, "has it as a seed; seeds belong to the first step");
        expect(!vertex.exists || vertex.kind == event.kind, "has it as a seed of another kind");
        break;
      case What::kInserted:
        expect(!vertex.exists, "inserts it, although it exists");
        break;
      case What::kRemoved:
        expect(vertex.exists, "removes it, although it does not exist");
        break;
      case What::kLearnt:
        expect(before.exists, "learns of it, although it does not exist");
        expect(before.kind == event.kind, "learns of it as one of another kind");
        break;
      case What::kForgotten:
        expect(!before.exists, "learns that it is removed, although it exists");
        break;
    }
    const bool is_there = event.what != What::kRemoved && event.what != What::kForgotten;
    if (is_change || event.what == What::kSeeded) vertex.exists = is_there;
    if (vertex.exists && is_there) vertex.kind = event.kind;
    vertex.is_on_rank[rank] = is_there;
  }
}

void VertexHistories::check_end(const Point& p, const Vertex& vertex) const {
  const auto ranks = ranks_that_know_.find(block_.grid().cube_at(p));
  if (ranks == ranks_that_know_.end()) return;
  for (const int rank : ranks->second) {
    const auto found = vertex.is_on_rank.find(rank);
    const bool is_there = found != vertex.is_on_rank.end() && found->second;
    if (is_there == vertex.exists) continue;
    fail(p,
         vertex.exists
             ? fmt::format("it exists at the end, and rank {}, which knows its cube, lacks it", rank)
             : fmt::format("it does not exist at the end, and rank {}, which knows its cube, has it", rank));
  }
}

}  // namespace podm
