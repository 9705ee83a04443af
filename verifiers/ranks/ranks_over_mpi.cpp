#include "ranks/ranks_over_mpi.h"

#define OMPI_SKIP_MPICXX 1  // skips MPI's C++ bindings, which were removed
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace podm::verify {
namespace {

void check(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw std::runtime_error(fmt::format("{} failed: {}", call, text.data()));
}

class RankOverMpi final : public Communication {
 public:
  explicit RankOverMpi(std::size_t most_bytes) : most_bytes_(most_bytes) {
    check(MPI_Comm_dup(MPI_COMM_WORLD, &all_), "MPI_Comm_dup");
    check(MPI_Comm_set_errhandler(all_, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
    check(MPI_Comm_rank(all_, &rank_), "MPI_Comm_rank");
    check(MPI_Comm_size(all_, &size_), "MPI_Comm_size");
  }
  ~RankOverMpi() override { MPI_Comm_free(&all_); }
  RankOverMpi(const RankOverMpi&) = delete;
  RankOverMpi& operator=(const RankOverMpi&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<Bytes> all_to_all(std::vector<Bytes> messages) override;

 private:
  // Calls start(begin, length, request) for each piece of a message of `length` bytes.
  template <class Start>
  void start_pieces(std::size_t length, const Start& start) {
    for (std::size_t begin = 0; begin < length; begin += most_bytes_) {
      requests_.push_back(MPI_REQUEST_NULL);
      start(begin, static_cast<int>(std::min(most_bytes_, length - begin)), &requests_.back());
    }
  }

  std::size_t most_bytes_;
  MPI_Comm all_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  std::vector<MPI_Request> requests_;
};

// Pieces between the same two ranks arrive in the order in which they are sent: MPI's non-overtaking rule.
// Each rank begins with its neighbours, so that not all ranks begin with rank 0.
std::vector<Bytes> RankOverMpi::all_to_all(std::vector<Bytes> messages) {
  const auto num_ranks = static_cast<std::size_t>(size_), own = static_cast<std::size_t>(rank_);
  std::vector<std::uint64_t> to_send(num_ranks), to_receive(num_ranks);
  for (std::size_t r = 0; r < num_ranks; ++r) to_send[r] = messages[r].size();
  check(MPI_Alltoall(to_send.data(), 1, MPI_UINT64_T, to_receive.data(), 1, MPI_UINT64_T, all_),
        "MPI_Alltoall");
  std::vector<Bytes> received(num_ranks);
  received[own] = std::move(messages[own]);
  requests_.clear();
  for (std::size_t i = 1; i < num_ranks; ++i) {
    const std::size_t from = (own + num_ranks - i) % num_ranks;
    Bytes& message = received[from];
    message.resize(to_receive[from]);
    start_pieces(message.size(), [&](std::size_t begin, int length, MPI_Request* request) {
      check(MPI_Irecv(message.data() + begin, length, MPI_BYTE, static_cast<int>(from), 0, all_, request),
            "MPI_Irecv");
    });
  }
  for (std::size_t i = 1; i < num_ranks; ++i) {
    const std::size_t to = (own + i) % num_ranks;
    const Bytes& message = messages[to];
    start_pieces(message.size(), [&](std::size_t begin, int length, MPI_Request* request) {
      check(MPI_Isend(message.data() + begin, length, MPI_BYTE, static_cast<int>(to), 0, all_, request),
            "MPI_Isend");
    });
  }
  check(MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE),
        "MPI_Waitall");
  return received;
}

}  // namespace

MpiSession::MpiSession(int& argc, char**& argv) {
  int provided = MPI_THREAD_SINGLE;
  check(MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread");
  if (provided < MPI_THREAD_FUNNELED)
    throw std::runtime_error("this MPI does not support programs with several threads (MPI_THREAD_FUNNELED)");
}

MpiSession::~MpiSession() { MPI_Finalize(); }

std::unique_ptr<Communication> ranks_over_mpi(std::size_t most_bytes) {
  return std::make_unique<RankOverMpi>(most_bytes);
}

int ranks_on_this_machine() {
  MPI_Comm machine = MPI_COMM_NULL;
  check(MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine),
        "MPI_Comm_split_type");
  int size = 1;
  check(MPI_Comm_size(machine, &size), "MPI_Comm_size");
  check(MPI_Comm_free(&machine), "MPI_Comm_free");
  return size;
}

void abort_all_ranks(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

}  // namespace podm::verify
