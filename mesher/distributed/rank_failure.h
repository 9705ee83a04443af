// What becomes of an exception that a rank throws.
#pragma once

#include <exception>
#include <string>

namespace podm {

struct RankFailure {
  int rank;
  std::string cause;             ///< as the rank told it
  std::exception_ptr exception;  ///< the same of InputError, InternalError and std::bad_alloc, else a
                                 ///< std::runtime_error; what() begins with "rank 3 of 8: "
};

/// The failure that is the exception being handled.
RankFailure current_rank_failure(int rank, int size);

}  // namespace podm
