// Concurrency: a mutex guards the messages, counts and the end of ranks. A collective has two phases. In the
// first each rank puts its messages down, in the second each takes its own; a rank leaves a phase when all
// ranks have reached its end. No rank therefore overwrites messages that another has yet to take.
#include "ranks/ranks_in_process.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace podm::verify {
namespace {

class MeetingPoint {
 public:
  explicit MeetingPoint(std::size_t num_ranks) : messages_(num_ranks) {}

  std::size_t num_ranks() const { return messages_.size(); }

  std::vector<Bytes> all_to_all(std::size_t rank, std::vector<Bytes> messages) {
    std::unique_lock lock(mutex_);
    messages_[rank] = std::move(messages);
    wait_for_all(lock);
    std::vector<Bytes> received(num_ranks());
    for (std::size_t from = 0; from < num_ranks(); ++from) received[from] = std::move(messages_[from][rank]);
    wait_for_all(lock);
    return received;
  }

  // Notes that a rank takes part in no further collective.
  void leave() {
    const std::scoped_lock lock(mutex_);
    has_left_ = true;
    changed_.notify_all();
  }

 private:
  void wait_for_all(std::unique_lock<std::mutex>& lock) {
    const std::uint64_t phase = phase_;
    if (++num_waiting_ == num_ranks()) {
      num_waiting_ = 0;
      ++phase_;
      changed_.notify_all();
      return;
    }
    changed_.wait(lock, [&] { return phase_ != phase || has_left_; });
    if (phase_ == phase) throw RankFailed("another rank has ended");
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::vector<Bytes>> messages_;  // by sender, then by receiver
  std::size_t num_waiting_ = 0;
  std::uint64_t phase_ = 0;
  bool has_left_ = false;
};

class RankInProcess final : public Communication {
 public:
  RankInProcess(MeetingPoint& meeting, std::size_t rank) : meeting_(meeting), rank_(rank) {}
  int rank() const override { return static_cast<int>(rank_); }
  int size() const override { return static_cast<int>(meeting_.num_ranks()); }
  std::vector<Bytes> all_to_all(std::vector<Bytes> messages) override {
    return meeting_.all_to_all(rank_, std::move(messages));
  }

 private:
  MeetingPoint& meeting_;
  std::size_t rank_;
};

}  // namespace

void run_ranks(int num_ranks, const std::function<void(Communication&)>& body) {
  MeetingPoint meeting(static_cast<std::size_t>(num_ranks));
  std::vector<std::exception_ptr> failures(meeting.num_ranks());
  {
    std::vector<std::jthread> threads;
    for (std::size_t rank = 0; rank < meeting.num_ranks(); ++rank) {
      threads.emplace_back([&, rank] {
        RankInProcess ranks(meeting, rank);
        try {
          body(ranks);
        } catch (const RankFailed&) {  // the rank that failed has an exception of its own
        } catch (...) {
          failures[rank] = std::current_exception();
        }
        meeting.leave();
      });
    }
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace podm::verify
