#include "distributed/in_process_ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <string_view>
#include <thread>

#include "distributed/rank_failure.h"
#include "runtime/processor_seconds.h"
#include "runtime/virtual_threads.h"

namespace podm {
namespace {

enum class Collective { kAllToAll, kAllGather, kSum, kMaximum, kBarrier };

std::string_view name_of(Collective collective) {
  static constexpr std::array<std::string_view, 5> kNames{"all_to_all", "all_gather", "sum", "maximum",
                                                          "barrier"};
  return kNames[static_cast<std::size_t>(collective)];
}

// The input of a rank to a collective, and its output.
struct Part {
  Collective collective;
  // All_to_all: one message to each rank, then one from each rank; all_gather: its own message, then all
  // messages.
  std::vector<Bytes> messages = {};
  std::span<std::uint64_t> values = {};
};

// The collective that all ranks must call: the one that the first rank called. After a failure its Part may
// be gone.
struct Agreed {
  int first = 0;
  Collective collective = Collective::kBarrier;
  std::size_t num_values = 0;
};

struct Traffic {
  std::uint64_t messages = 0, bytes = 0;

  void add(std::uint64_t message_bytes) {
    messages += message_bytes > 0;
    bytes += message_bytes;
  }
};

struct RankState {
  std::condition_variable resumed;
  bool may_run = false;
  Part* part = nullptr;  // input to the collective in which it waits
  double since_s = 0;    // processor seconds of its thread that its clock already includes
  double clock_s = 0;
  VirtualThreads threads;
  RankReport report;

  void charge(double seconds) {
    clock_s += seconds;
    report.computing_s += seconds;
  }
  void look_at_processor() {
    const double now_s = processor_seconds();
    charge(now_s - since_s - threads.take_saved_s());
    since_s = now_s;
  }
};

// The meeting place of all ranks. The last rank to arrive carries out the collective for all ranks while the
// others wait. A rank that computes owns its clock and report; one mutex protects everything else, except
// announcements: they are single numbers that order no other data, and therefore relaxed atomics.
class MeetingPlace {
 public:
  explicit MeetingPlace(const InProcessOptions& options);

  int size() const { return options_.num_ranks; }
  bool has_virtual_threads() const { return options_.has_virtual_threads; }
  RankState& state(int rank) { return ranks_[static_cast<std::size_t>(rank)]; }
  const std::optional<RankFailure>& failure() const { return failure_; }
  std::vector<RankReport> reports() const;

  /// Returns when the rank may compute, like take_part(). Throws RankFailed after another rank failed.
  void begin(int rank);
  /// Throws InternalError if the ranks call different collectives.
  void take_part(int rank, Part& part);
  /// Notes that the rank has returned. Throws as take_part() does.
  void end(int rank);
  /// Ends the rank with the exception that is being handled.
  void end_by_exception(int rank);
  void announce(std::uint64_t value) { raise(options_.one_at_a_time ? announced_ : heard_, value); }
  std::uint64_t heard() const { return heard_.load(std::memory_order_relaxed); }

 private:
  static void raise(std::atomic<std::uint64_t>& largest, std::uint64_t value);
  void wait_for_turn(std::unique_lock<std::mutex>& lock, RankState& self);
  void throw_if_failed() const;
  void fail(int rank);
  void resume(RankState& rank);
  void let_run();
  void pass_turn();
  void check_agreement(const Part& part);
  void meet(Collective collective);
  double seconds_of_all_to_all();
  double seconds_of_all_gather();
  double seconds_of_reduction();
  void exchange();
  void gather();
  template <class Combine>
  void reduce(const Combine& combine);
  void move_clocks(double network_s);

  InProcessOptions options_;
  std::mutex mutex_;
  std::mt19937_64 random_;
  std::vector<RankState> ranks_;
  std::vector<std::size_t> order_;  // order in which the ranks compute
  std::size_t turn_ = 0;
  double num_steps_;  // depth of a tree over all ranks
  std::size_t num_waiting_ = 0;
  Agreed agreed_;             // call of the ranks that wait, if any
  std::optional<int> ended_;  // a rank that has returned, if any
  std::optional<RankFailure> failure_;
  std::atomic<std::uint64_t> announced_ = 0, heard_ = 0;  // announced_: to be heard after the next collective
};

MeetingPlace::MeetingPlace(const InProcessOptions& options)
    : options_(options),
      random_(options.seed),
      ranks_(static_cast<std::size_t>(options.num_ranks)),
      order_(ranks_.size()),
      num_steps_(static_cast<double>(std::bit_width(ranks_.size() - 1))) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  let_run();
}

std::vector<RankReport> MeetingPlace::reports() const {
  std::vector<RankReport> reports;
  for (const RankState& rank : ranks_) reports.push_back(rank.report);
  return reports;
}

void MeetingPlace::begin(int rank) {
  std::unique_lock lock(mutex_);
  wait_for_turn(lock, state(rank));
}

void MeetingPlace::take_part(int rank, Part& part) {
  RankState& self = state(rank);
  self.look_at_processor();
  std::unique_lock lock(mutex_);
  throw_if_failed();
  try {
    check_agreement(part);
    self.part = &part;
    self.may_run = false;
    if (num_waiting_++ == 0) agreed_ = {rank, part.collective, part.values.size()};
    if (num_waiting_ == ranks_.size()) {
      meet(part.collective);
    } else {
      pass_turn();
    }
  } catch (...) {
    fail(rank);
    throw;
  }
  wait_for_turn(lock, self);
}

void MeetingPlace::end(int rank) {
  state(rank).look_at_processor();
  const std::scoped_lock lock(mutex_);
  ended_ = rank;
  if (num_waiting_ > 0)
    throw InternalError(
        fmt::format("it ended where rank {} called {}", agreed_.first, name_of(agreed_.collective)));
  pass_turn();
}

void MeetingPlace::end_by_exception(int rank) {
  const std::scoped_lock lock(mutex_);
  fail(rank);
}

void MeetingPlace::wait_for_turn(std::unique_lock<std::mutex>& lock, RankState& self) {
  self.resumed.wait(lock, [&] { return self.may_run || failure_; });
  throw_if_failed();
  self.since_s = processor_seconds();
}

void MeetingPlace::throw_if_failed() const {
  if (failure_)
    throw RankFailed(fmt::format("rank {} of {} failed: {}", failure_->rank, size(), failure_->cause));
}

// Records the exception that is being handled. Only the first failure counts, because later failures may
// follow from it.
void MeetingPlace::fail(int rank) {
  if (failure_) return;
  failure_ = current_rank_failure(rank, size());
  for (RankState& waiting : ranks_) waiting.resumed.notify_one();
}

void MeetingPlace::resume(RankState& rank) {
  rank.may_run = true;
  rank.resumed.notify_one();
}

// Lets all ranks compute, at once or one after the other.
void MeetingPlace::let_run() {
  if (options_.one_at_a_time) {
    std::shuffle(order_.begin(), order_.end(), random_);
    turn_ = 0;
    resume(ranks_[order_[0]]);
  } else {
    for (RankState& rank : ranks_) resume(rank);
  }
}

// Passes the turn on. The rank whose turn it was does not compute until all ranks have met.
void MeetingPlace::pass_turn() {
  if (options_.one_at_a_time && ++turn_ < order_.size()) resume(ranks_[order_[turn_]]);
}

void MeetingPlace::check_agreement(const Part& part) {
  const auto fault = [&](const std::string& what) {
    throw InternalError(fmt::format("it called {} where rank {}", name_of(part.collective), what));
  };
  if (ended_) fault(fmt::format("{} ended", *ended_));
  if (num_waiting_ == 0) return;
  if (part.collective != agreed_.collective)
    fault(fmt::format("{} called {}", agreed_.first, name_of(agreed_.collective)));
  if (part.values.size() != agreed_.num_values)
    fault(fmt::format("{} called it with {} values, not {}", agreed_.first, agreed_.num_values,
                      part.values.size()));
}

// Carries out the collective in which all ranks wait.
void MeetingPlace::meet(Collective collective) {
  double network_s = 0;
  switch (collective) {
    case Collective::kAllToAll:
      network_s = seconds_of_all_to_all();
      exchange();
      break;
    case Collective::kAllGather:
      network_s = seconds_of_all_gather();
      gather();
      break;
    case Collective::kSum:
      network_s = seconds_of_reduction();
      reduce([](std::uint64_t a, std::uint64_t b) { return a + b; });
      break;
    case Collective::kMaximum:
      network_s = seconds_of_reduction();
      reduce([](std::uint64_t a, std::uint64_t b) { return std::max(a, b); });
      break;
    case Collective::kBarrier:
      network_s = num_steps_ * options_.latency_s;
      break;
  }
  move_clocks(network_s);
  raise(heard_, announced_.load(std::memory_order_relaxed));
  num_waiting_ = 0;
  let_run();
}

// Sets `largest` to the value if it is less.
void MeetingPlace::raise(std::atomic<std::uint64_t>& largest, std::uint64_t value) {
  std::uint64_t present = largest.load(std::memory_order_relaxed);
  while (present < value && !largest.compare_exchange_weak(present, value, std::memory_order_relaxed)) {
  }
}

double MeetingPlace::seconds_of_all_to_all() {
  std::vector<Traffic> sent(ranks_.size()), received(ranks_.size());
  for (std::size_t from = 0; from < ranks_.size(); ++from)
    for (std::size_t to = 0; to < ranks_.size(); ++to) {
      if (from == to) continue;
      const std::size_t bytes = ranks_[from].part->messages[to].size();
      sent[from].add(bytes);
      received[to].add(bytes);
    }
  double busiest_s = 0;
  for (std::size_t i = 0; i < ranks_.size(); ++i) {
    const auto messages = static_cast<double>(std::max(sent[i].messages, received[i].messages));
    const auto bytes = static_cast<double>(std::max(sent[i].bytes, received[i].bytes));
    busiest_s = std::max(busiest_s, options_.latency_s * messages + bytes / options_.bytes_per_s);
    ranks_[i].report.messages_sent += sent[i].messages;
    ranks_[i].report.bytes_sent += sent[i].bytes;
  }
  const double lengths_bytes = 4 * static_cast<double>(ranks_.size());
  return num_steps_ * (options_.latency_s + lengths_bytes / options_.bytes_per_s) + busiest_s;
}

double MeetingPlace::seconds_of_all_gather() {
  std::uint64_t total_bytes = 8 * ranks_.size();
  for (RankState& rank : ranks_) {
    const std::size_t bytes = rank.part->messages[0].size();
    total_bytes += bytes;
    for (std::size_t other = 1; other < ranks_.size(); ++other) {
      rank.report.messages_sent += bytes > 0;
      rank.report.bytes_sent += bytes;
    }
  }
  if (ranks_.size() == 1) return 0;
  return 2 * num_steps_ * options_.latency_s + static_cast<double>(total_bytes) / options_.bytes_per_s;
}

double MeetingPlace::seconds_of_reduction() {
  const double bytes = 8 * static_cast<double>(agreed_.num_values);
  return num_steps_ * (options_.latency_s + bytes / options_.bytes_per_s);
}

void MeetingPlace::exchange() {
  for (std::size_t i = 0; i < ranks_.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) std::swap(ranks_[i].part->messages[j], ranks_[j].part->messages[i]);
}

void MeetingPlace::gather() {
  std::vector<Bytes> all;
  for (RankState& rank : ranks_) all.push_back(std::move(rank.part->messages[0]));
  for (RankState& rank : ranks_) rank.part->messages = all;
}

template <class Combine>
void MeetingPlace::reduce(const Combine& combine) {
  const std::span<std::uint64_t> first = ranks_[0].part->values;
  for (std::size_t i = 1; i < ranks_.size(); ++i)
    std::transform(first.begin(), first.end(), ranks_[i].part->values.begin(), first.begin(), combine);
  for (std::size_t i = 1; i < ranks_.size(); ++i)
    std::copy(first.begin(), first.end(), ranks_[i].part->values.begin());
}

void MeetingPlace::move_clocks(double network_s) {
  double latest_s = 0;
  for (const RankState& rank : ranks_) latest_s = std::max(latest_s, rank.clock_s);
  for (RankState& rank : ranks_) {
    rank.report.waiting_s += latest_s - rank.clock_s;
    rank.report.network_s += network_s;
    rank.clock_s = latest_s + network_s;
  }
}

class InProcessRank final : public Communication {
 public:
  InProcessRank(MeetingPlace& place, int rank) : place_(place), state_(place.state(rank)), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return place_.size(); }
  std::vector<Bytes> all_to_all(std::vector<Bytes> messages) override {
    check_one_per_rank(messages);
    return take_part({Collective::kAllToAll, std::move(messages)});
  }
  std::vector<Bytes> all_gather(Bytes message) override {
    std::vector<Bytes> messages;
    messages.push_back(std::move(message));
    return take_part({Collective::kAllGather, std::move(messages)});
  }
  void sum(std::span<std::uint64_t> values) override { take_part({Collective::kSum, {}, values}); }
  void maximum(std::span<std::uint64_t> values) override { take_part({Collective::kMaximum, {}, values}); }
  void barrier() override { take_part({Collective::kBarrier}); }
  void announce(std::uint64_t value) override {
    announced_ = std::max(announced_, value);
    place_.announce(value);
  }
  std::uint64_t announced() override { return std::max(announced_, place_.heard()); }

  double seconds() const override {
    state_.look_at_processor();
    return state_.clock_s;
  }
  bool is_virtual() const override { return true; }
  RankReport report() const override {
    state_.look_at_processor();
    return state_.report;
  }
  void charge(double seconds) override { state_.charge(seconds); }

 private:
  std::vector<Bytes> take_part(Part part) {
    place_.take_part(rank_, part);
    return std::move(part.messages);
  }

  MeetingPlace& place_;
  RankState& state_;
  int rank_;
  std::uint64_t announced_ = 0;  // the largest value of its own
};

void run_rank(MeetingPlace& place, int rank, const std::function<void(Communication&)>& body) try {
  std::optional<VirtualThreads::Scope> threads;
  if (place.has_virtual_threads()) threads.emplace(place.state(rank).threads);
  place.begin(rank);
  InProcessRank communication(place, rank);
  body(communication);
  place.end(rank);
} catch (...) {
  place.end_by_exception(rank);
}

}  // namespace

std::vector<RankReport> run_ranks(const InProcessOptions& options,
                                  const std::function<void(Communication&)>& body) {
  if (options.num_ranks < 1)
    throw InputError(fmt::format("{} ranks: at least one is needed", options.num_ranks));
  MeetingPlace place(options);
  {
    std::vector<std::jthread> threads;
    for (int rank = 0; rank < options.num_ranks; ++rank) try {
        threads.emplace_back([&place, &body, rank] { run_rank(place, rank, body); });
      } catch (...) {  // no thread was available: the ranks that already run end now
        place.end_by_exception(rank);
        break;
      }
  }
  if (place.failure()) std::rethrow_exception(place.failure()->exception);
  return place.reports();
}

}  // namespace podm
