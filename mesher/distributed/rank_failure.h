// Conversion of an exception that a rank throws.
#pragma once

#include <exception>
#include <string>

namespace podm {

struct RankFailure {
  int rank;
  std::string cause;  ///< the text of the rank's exception
  /// The same type if it is InputError, InternalError or std::bad_alloc, otherwise a std::runtime_error;
  /// what() begins with "rank 3 of 8: ".
  std::exception_ptr exception;
};

/// Returns the failure for the exception that is being handled.
RankFailure current_rank_failure(int rank, int size);

}  // namespace podm
