#include "replay/merge_logs.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "geometry/point_hash.h"
#include "podm/errors.h"

namespace podm {

namespace {

Point point_of(const LoggedOperation& logged) { return {logged.point[0], logged.point[1], logged.point[2]}; }

// Reads one rank's log from front to back.
class Reader {
 public:
  explicit Reader(const LogOfRank& of) : path_(of.path), head_(of.log.head), all_(of.log.all) {}

  const std::string& path() const { return path_; }
  int rank() const { return head_.rank; }
  bool is_over() const { return next_ == all_.operations.size(); }
  const LoggedOperation& next() const { return all_.operations[next_]; }
  bool is_in(std::uint64_t step) const { return !is_over() && step_of(next().sequence) == step; }
  /// The vertices that the next entry removes.
  std::span<const std::uint32_t> removed() const {
    return {all_.removed.data() + next_removed_, next().num_removed};
  }
  void advance() {
    next_removed_ += next().num_removed;
    ++next_;
  }
  void expect(bool holds, const std::string& fault) const {
    if (!holds) throw InputError(fmt::format("{}: {}: {}", path_, operation_text(next().sequence), fault));
  }

  std::unordered_map<std::uint32_t, Point> vertices;  // the vertices that the rank knows, by its numbers

 private:
  const std::string& path_;
  const OperationLogHead& head_;
  const OperationBatch& all_;
  std::size_t next_ = 0, next_removed_ = 0;
};

class Merge {
 public:
  explicit Merge(const std::vector<LogOfRank>& logs) {
    for (const LogOfRank& log : logs) ranks_.emplace_back(log);
  }

  OperationBatch operator()() {
    while (const std::optional<std::uint64_t> step = next_step())
      for (Reader& rank : ranks_)
        for (; rank.is_in(*step); rank.advance()) carry_out(rank);
    return std::move(whole_);
  }

 private:
  struct Vertex {
    std::uint32_t id, kind;
  };

  // The least step that comes next in any log.
  std::optional<std::uint64_t> next_step() const {
    std::optional<std::uint64_t> step;
    for (const Reader& rank : ranks_) {
      if (rank.is_over()) continue;
      const std::uint64_t its = step_of(rank.next().sequence);
      if (!step || its < *step) step = its;
    }
    return step;
  }

  void carry_out(Reader& rank) {
    const LoggedOperation& logged = rank.next();
    if (logged.kind == kReceivedRemoval) {
      remove_received(rank);
    } else if (logged.kind == kMovedVertex) {
      move(rank);
    } else if (logged.kind >= kSeed) {
      seed(rank);
    } else if (logged.kind >= kReceivedInsertion && logged.kind < kReceivedRemoval) {
      insert_received(rank);
    } else {
      apply(rank, rank.next());
    }
  }

  void remove_received(Reader& rank) {
    rank.expect(rank.removed().size() == 1, "a received removal must name one vertex");
    const Point p = take_removed(rank, rank.removed().front());
    rank.expect(p == point_of(rank.next()), "a received removal names a vertex at another point");
    rank.expect(!vertices_.contains(p), "a received removal names a vertex that no rank has removed");
  }

  // The vertex stays the same in the whole, where its point identifies it.
  void move(Reader& rank) {
    rank.expect(rank.removed().size() == 1, "a move must name one vertex");
    const Point p = take_removed(rank, rank.removed().front());
    rank.expect(p == point_of(rank.next()), "moves a vertex that is at another point");
    give_number(rank);
  }

  void insert_received(Reader& rank) {
    const LoggedOperation& logged = rank.next();
    rank.expect(logged.num_removed == 0, "a received vertex removes another one");
    const auto found = vertices_.find(point_of(logged));
    rank.expect(found != vertices_.end(), "receives a vertex that no rank has inserted");
    rank.expect(found->second.kind == logged.kind - kReceivedInsertion,
                "receives a vertex of another kind than the inserted one");
    give_number(rank);
  }

  void seed(Reader& rank) {
    LoggedOperation logged = rank.next();
    rank.expect(step_of(logged.sequence) == 0, "a seed after the first step");
    rank.expect(logged.num_removed == 0, "a seed removes a vertex");
    logged.kind -= kSeed;
    if (const auto found = vertices_.find(point_of(logged)); found == vertices_.end()) {
      apply(rank, logged);
    } else {
      rank.expect(found->second.kind == logged.kind, "a seed of another kind than another rank's");
      give_number(rank);
    }
  }

  // `logged` is the next entry of the rank's log, as an operation of the whole.
  void apply(Reader& rank, LoggedOperation logged) {
    for (const std::uint32_t vertex : rank.removed()) {
      const auto found = vertices_.find(take_removed(rank, vertex));
      rank.expect(found != vertices_.end(), "removes a vertex that another rank has removed");
      whole_.removed.push_back(found->second.id);
      vertices_.erase(found);
    }
    give_number(rank);
    rank.expect(num_vertices_ <= std::numeric_limits<std::uint32_t>::max(),
                "the logs of all ranks insert more than 2^32 vertices, more than a log can name");
    const auto id = static_cast<std::uint32_t>(num_vertices_++);
    rank.expect(vertices_.emplace(point_of(logged), Vertex{id, logged.kind}).second,
                "its point is a vertex already");
    logged.vertex = id;
    logged.worker = worker_in_whole(rank.rank(), logged.worker);
    whole_.operations.push_back(logged);
  }

  static Point take_removed(Reader& rank, std::uint32_t vertex) {
    const auto found = rank.vertices.find(vertex);
    rank.expect(found != rank.vertices.end(), "removes a vertex that does not exist");
    const Point p = found->second;
    rank.vertices.erase(found);
    return p;
  }
  static void give_number(Reader& rank) {
    const LoggedOperation& logged = rank.next();
    rank.expect(rank.vertices.emplace(logged.vertex, point_of(logged)).second, "its vertex exists already");
  }

  std::vector<Reader> ranks_;
  ByPoint<Vertex> vertices_;  // the present vertices of the whole
  std::uint64_t num_vertices_ = 0;
  OperationBatch whole_;
};

// Checks that all logs are of one run, with one log per rank. They are sorted by rank.
void expect_one_run(const std::vector<LogOfRank>& logs) {
  const auto run_of = [](const OperationLogHead& head) {
    return std::tie(head.num_ranks, head.box, head.image_sha256, head.space, head.mesh_sha256, head.mesh_hash,
                    head.smoothing_mm, head.is_box_flat);
  };
  const LogOfRank& first = logs.front();
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const auto& [path, log] = logs[i];
    if (run_of(log.head) != run_of(first.log.head))
      throw InputError(fmt::format("{}: the log is of another run than {}", path, first.path));
    if (i > 0 && log.head.rank == logs[i - 1].log.head.rank)
      throw InputError(fmt::format("{}: a second log of rank {} of {}; the first is {}", path, log.head.rank,
                                   log.head.num_ranks, logs[i - 1].path));
  }
  for (int rank = 0; rank < first.log.head.num_ranks; ++rank)
    if (const auto i = static_cast<std::size_t>(rank); i >= logs.size() || logs[i].log.head.rank != rank)
      throw InputError(
          fmt::format("{}: the log of rank {} of {} is missing", first.path, rank, first.log.head.num_ranks));
}

}  // namespace

OperationLog merge_logs(std::vector<LogOfRank> logs) {
  std::stable_sort(logs.begin(), logs.end(),
                   [](const LogOfRank& a, const LogOfRank& b) { return a.log.head.rank < b.log.head.rank; });
  expect_one_run(logs);
  if (logs.size() == 1) return std::move(logs.front().log);
  return {.head = logs.front().log.head, .all = Merge(logs)()};
}

}  // namespace podm
