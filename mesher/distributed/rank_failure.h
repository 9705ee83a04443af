// Conversion of an exception that a rank throws.
#pragma once

#include <array>
#include <exception>
#include <new>
#include <string>
#include <string_view>

namespace podm {

/// A lack of memory with a text, which is cut off if it is long. It allocates no memory itself.
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(std::string_view what) { what.copy(what_.data(), what_.size() - 1); }
  /// The lack of memory of a rank.
  OutOfMemory(int rank, int size, std::string_view cause);
  const char* what() const noexcept override { return what_.data(); }

 private:
  std::array<char, 320> what_{};
};

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
