#include "distributed/mpi_communication.h"

#define OMPI_SKIP_MPICXX 1  // skips MPI's C++ bindings, which were removed
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <exception>
#include <functional>
#include <numeric>
#include <thread>
#include <utility>

namespace podm {
namespace {

void check(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw std::runtime_error(fmt::format("{} failed: {}", call, text.data()));
}

// Returns the processor time of all threads of this process.
double process_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Time spent in collectives: wall time, and processor time, because a rank that waits keeps the processor
// busy.
struct InCollectives {
  double wall_s = 0, processor_s = 0;
};

class CollectiveClock {
 public:
  explicit CollectiveClock(InCollectives& sum) : sum_(sum) {}
  ~CollectiveClock() {
    sum_.wall_s += MPI_Wtime() - wall_start_s_;
    sum_.processor_s += process_seconds() - processor_start_s_;
  }
  CollectiveClock(const CollectiveClock&) = delete;
  CollectiveClock& operator=(const CollectiveClock&) = delete;

 private:
  InCollectives& sum_;
  const double wall_start_s_ = MPI_Wtime(), processor_start_s_ = process_seconds();
};

class MpiCommunication final : public Communication {
 public:
  explicit MpiCommunication(std::size_t most_bytes) : most_bytes_(most_bytes) {
    check(MPI_Comm_dup(MPI_COMM_WORLD, &all_), "MPI_Comm_dup");
    check(MPI_Comm_set_errhandler(all_, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
    check(MPI_Comm_rank(all_, &rank_), "MPI_Comm_rank");
    check(MPI_Comm_size(all_, &size_), "MPI_Comm_size");
    check(MPI_Comm_dup(all_, &announcements_), "MPI_Comm_dup");
  }
  ~MpiCommunication() override;
  MpiCommunication(const MpiCommunication&) = delete;
  MpiCommunication& operator=(const MpiCommunication&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<Bytes> all_to_all(std::vector<Bytes> messages) override;
  std::vector<Bytes> all_gather(Bytes message) override;
  void sum(std::span<std::uint64_t> values) override { reduce(values, MPI_UINT64_T, MPI_SUM); }
  // MPICH 4.0 compares unsigned 64-bit values as signed ones. With its first bit changed a value has its
  // place in both orders.
  void maximum(std::span<std::uint64_t> values) override {
    constexpr std::uint64_t kFirstBit = std::uint64_t{1} << 63;
    for (std::uint64_t& value : values) value ^= kFirstBit;
    reduce(values, MPI_INT64_T, MPI_MAX);
    for (std::uint64_t& value : values) value ^= kFirstBit;
  }
  void barrier() override {
    const CollectiveClock clock(in_collectives_);
    MPI_Request all_have_come = MPI_REQUEST_NULL;
    check(MPI_Ibarrier(all_, &all_have_come), "MPI_Ibarrier");
    wait(all_have_come);
  }
  void announce(std::uint64_t value) override;
  std::uint64_t announced() override;
  void look_while_waiting(std::function<void()> look) override { look_ = std::move(look); }
  double seconds() const override { return MPI_Wtime(); }
  RankReport report() const override {
    RankReport report = sent_;
    report.computing_s = process_seconds() - start_s_ - in_collectives_.processor_s;
    report.waiting_s = in_collectives_.wall_s;
    return report;
  }

 private:
  void start_receiving(Bytes& message, int from, std::vector<MPI_Request>& requests);
  void start_sending(const Bytes& message, int to, std::vector<MPI_Request>& requests);
  void reduce(std::span<std::uint64_t> values, MPI_Datatype type, MPI_Op operation);
  void receive_announcement();
  void wait(MPI_Request& collective) const;
  std::size_t num_ranks() const { return static_cast<std::size_t>(size_); }
  void note_sent(const Bytes& message) {
    sent_.messages_sent += !message.empty();
    sent_.bytes_sent += message.size();
  }

  const int uncaught_ = std::uncaught_exceptions();
  const double start_s_ = process_seconds();
  InCollectives in_collectives_;
  RankReport sent_;
  std::size_t most_bytes_;
  std::function<void()> look_;  // called while a collective waits; empty: nothing
  MPI_Comm all_ = MPI_COMM_NULL, announcements_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  std::deque<std::uint64_t> announced_;  // values that this rank sent, which must stay where they are
  std::vector<MPI_Request> announcing_;  // sends of these values
  std::uint64_t largest_announced_ = 0, num_received_ = 0;
};

// Sends the messages one by one, directly from and to their own memory. MPI_Alltoallv would require copies of
// all messages in one array, of less than 2^31 bytes. Each rank begins with its neighbours, so that not all
// ranks begin with rank 0.
std::vector<Bytes> MpiCommunication::all_to_all(std::vector<Bytes> messages) {
  check_one_per_rank(messages);
  const CollectiveClock clock(in_collectives_);
  std::vector<std::uint64_t> to_send(num_ranks()), to_receive(num_ranks());
  for (std::size_t i = 0; i < num_ranks(); ++i) to_send[i] = messages[i].size();
  MPI_Request all_have_come = MPI_REQUEST_NULL;
  check(MPI_Ialltoall(to_send.data(), 1, MPI_UINT64_T, to_receive.data(), 1, MPI_UINT64_T, all_,
                      &all_have_come),
        "MPI_Ialltoall");
  wait(all_have_come);

  std::vector<Bytes> received(num_ranks());
  received[static_cast<std::size_t>(rank_)] = std::move(messages[static_cast<std::size_t>(rank_)]);
  std::vector<MPI_Request> requests;
  for (int i = 1; i < size_; ++i) {
    const int from = (rank_ - i + size_) % size_;
    Bytes& message = received[static_cast<std::size_t>(from)];
    message.resize(to_receive[static_cast<std::size_t>(from)]);
    start_receiving(message, from, requests);
  }
  for (int i = 1; i < size_; ++i) {
    const int to = (rank_ + i) % size_;
    const Bytes& message = messages[static_cast<std::size_t>(to)];
    note_sent(message);
    start_sending(message, to, requests);
  }
  check(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE), "MPI_Waitall");
  return received;
}

// Pieces between the same two ranks arrive in the order in which they are sent: MPI's non-overtaking rule.
void MpiCommunication::start_receiving(Bytes& message, int from, std::vector<MPI_Request>& requests) {
  for (std::size_t begin = 0; begin < message.size(); begin += most_bytes_) {
    const auto length = static_cast<int>(std::min(most_bytes_, message.size() - begin));
    requests.push_back(MPI_REQUEST_NULL);
    check(MPI_Irecv(message.data() + begin, length, MPI_BYTE, from, 0, all_, &requests.back()), "MPI_Irecv");
  }
}

void MpiCommunication::start_sending(const Bytes& message, int to, std::vector<MPI_Request>& requests) {
  for (std::size_t begin = 0; begin < message.size(); begin += most_bytes_) {
    const auto length = static_cast<int>(std::min(most_bytes_, message.size() - begin));
    requests.push_back(MPI_REQUEST_NULL);
    check(MPI_Isend(message.data() + begin, length, MPI_BYTE, to, 0, all_, &requests.back()), "MPI_Isend");
  }
}

// Sends the messages in pieces, one piece of every message per call, so that the pieces fit one call
// together. Short messages need one call.
std::vector<Bytes> MpiCommunication::all_gather(Bytes message) {
  const CollectiveClock clock(in_collectives_);
  for (int other = 1; other < size_; ++other) note_sent(message);
  const std::uint64_t length = message.size();
  std::vector<std::uint64_t> lengths(num_ranks());
  MPI_Request all_have_come = MPI_REQUEST_NULL;
  check(MPI_Iallgather(&length, 1, MPI_UINT64_T, lengths.data(), 1, MPI_UINT64_T, all_, &all_have_come),
        "MPI_Iallgather");
  wait(all_have_come);

  std::vector<Bytes> all(num_ranks());
  for (std::size_t i = 0; i < num_ranks(); ++i) all[i].resize(lengths[i]);
  const std::size_t most_of_each = std::max<std::size_t>(1, most_bytes_ / num_ranks());
  const std::uint64_t longest = *std::max_element(lengths.begin(), lengths.end());
  std::vector<int> counts(num_ranks()), places(num_ranks());
  for (std::size_t begin = 0; begin < longest; begin += most_of_each) {
    for (std::size_t i = 0; i < num_ranks(); ++i)
      counts[i] = static_cast<int>(std::min(most_of_each, lengths[i] - std::min(begin, lengths[i])));
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0);
    Bytes pieces(static_cast<std::size_t>(places.back() + counts.back()));
    const auto own = static_cast<std::size_t>(rank_);
    check(MPI_Allgatherv(message.data() + std::min<std::size_t>(begin, length), counts[own], MPI_BYTE,
                         pieces.data(), counts.data(), places.data(), MPI_BYTE, all_),
          "MPI_Allgatherv");
    for (std::size_t i = 0; i < num_ranks(); ++i)
      std::copy_n(pieces.begin() + places[i], counts[i],
                  all[i].begin() + static_cast<std::ptrdiff_t>(std::min(begin, lengths[i])));
  }
  return all;
}

void MpiCommunication::reduce(std::span<std::uint64_t> values, MPI_Datatype type, MPI_Op operation) {
  const CollectiveClock clock(in_collectives_);
  const std::size_t most_values = most_bytes_ / sizeof(std::uint64_t);
  for (std::size_t begin = 0; begin < values.size(); begin += most_values) {
    const auto piece = values.subspan(begin, std::min(most_values, values.size() - begin));
    MPI_Request all_have_come = MPI_REQUEST_NULL;
    check(MPI_Iallreduce(MPI_IN_PLACE, piece.data(), static_cast<int>(piece.size()), type, operation, all_,
                         &all_have_come),
          "MPI_Iallreduce");
    wait(all_have_come);
  }
}

// Each collective waits here until all ranks have called it. Short waits are busy, because a rank that sleeps
// is late. Long ones leave the processor to others.
void MpiCommunication::wait(MPI_Request& collective) const {
  constexpr double kBusyS = 1e-3;
  constexpr std::chrono::microseconds kSleep(100);
  const double start_s = MPI_Wtime();
  for (;;) {
    int has_ended = 0;
    check(MPI_Test(&collective, &has_ended, MPI_STATUS_IGNORE), "MPI_Test");
    if (has_ended != 0) return;
    if (MPI_Wtime() - start_s < kBusyS) continue;
    if (look_) look_();
    std::this_thread::sleep_for(kSleep);
  }
}

// Announcements have a communicator of their own, so that no collective mixes with them. A rank looks for
// them by MPI_Iprobe, which also lets MPI deliver messages while a rank computes. One-sided communication
// would require no call of the receiver, but several implementations carry it out only when the receiver
// calls MPI.
void MpiCommunication::announce(std::uint64_t value) {
  largest_announced_ = std::max(largest_announced_, value);
  announced_.push_back(value);
  for (int i = 1; i < size_; ++i) {
    announcing_.push_back(MPI_REQUEST_NULL);
    check(MPI_Isend(&announced_.back(), 1, MPI_UINT64_T, (rank_ + i) % size_, 0, announcements_,
                    &announcing_.back()),
          "MPI_Isend");
  }
}

std::uint64_t MpiCommunication::announced() {
  for (;;) {
    int has_come = 0;
    check(MPI_Iprobe(MPI_ANY_SOURCE, 0, announcements_, &has_come, MPI_STATUS_IGNORE), "MPI_Iprobe");
    if (has_come == 0) return largest_announced_;
    receive_announcement();
  }
}

void MpiCommunication::receive_announcement() {
  std::uint64_t value = 0;
  check(MPI_Recv(&value, 1, MPI_UINT64_T, MPI_ANY_SOURCE, 0, announcements_, MPI_STATUS_IGNORE), "MPI_Recv");
  ++num_received_;
  largest_announced_ = std::max(largest_announced_, value);
}

// MPI requires that every message is received, so the ranks first receive the announcements that are still on
// their way. A rank that an exception unwinds does not wait for the others, which may never come here; its
// process aborts all ranks.
MpiCommunication::~MpiCommunication() {
  if (std::uncaught_exceptions() > uncaught_) return;
  try {
    std::array<std::uint64_t, 1> num_announced{announced_.size()};
    sum(num_announced);
    while (num_received_ < num_announced[0] - announced_.size()) receive_announcement();
    check(MPI_Waitall(static_cast<int>(announcing_.size()), announcing_.data(), MPI_STATUSES_IGNORE),
          "MPI_Waitall");
  } catch (const std::exception&) {  // MPI has failed, and MPI_Finalize reports it
  }
  MPI_Comm_free(&announcements_);
  MPI_Comm_free(&all_);
}

}  // namespace

MpiSession::MpiSession(int& argc, char**& argv) {
  int provided = MPI_THREAD_SINGLE;
  check(MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread");
  if (provided < MPI_THREAD_FUNNELED)
    throw std::runtime_error("this MPI does not support programs with several threads (MPI_THREAD_FUNNELED)");
}

MpiSession::~MpiSession() { MPI_Finalize(); }

std::unique_ptr<Communication> mpi_communication(std::size_t most_bytes) {
  return std::make_unique<MpiCommunication>(most_bytes);
}

void abort_all_ranks(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

}  // namespace podm
