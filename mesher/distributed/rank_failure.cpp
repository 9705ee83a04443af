#include "distributed/rank_failure.h"

#include <fmt/format.h>

#include <array>
#include <new>
#include <stdexcept>

#include "podm/errors.h"

namespace podm {
namespace {

// An out-of-memory error that allocates no memory itself.
class RankOutOfMemory : public std::bad_alloc {
 public:
  RankOutOfMemory(int rank, int size) {
    *fmt::format_to_n(what_.data(), what_.size() - 1, "rank {} of {}: out of memory", rank, size).out = '\0';
  }
  const char* what() const noexcept override { return what_.data(); }

 private:
  std::array<char, 64> what_;
};

}  // namespace

RankFailure current_rank_failure(int rank, int size) {
  const auto as = [&](auto error, const char* cause) {
    const std::string what = fmt::format("rank {} of {}: {}", rank, size, cause);
    return RankFailure{rank, cause, std::make_exception_ptr(decltype(error)(what))};
  };
  try {
    throw;
  } catch (const InputError& error) {
    return as(error, error.what());
  } catch (const InternalError& error) {
    return as(error, error.what());
  } catch (const std::bad_alloc&) {
    return {rank, "out of memory", std::make_exception_ptr(RankOutOfMemory(rank, size))};
  } catch (const std::exception& error) {
    return as(std::runtime_error(""), error.what());
  } catch (...) {
    return as(std::runtime_error(""), "an exception of unknown type");
  }
}

}  // namespace podm
