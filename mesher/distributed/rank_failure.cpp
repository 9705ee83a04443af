#include "distributed/rank_failure.h"

#include <fmt/format.h>

#include <stdexcept>

#include "podm/errors.h"

namespace podm {

OutOfMemory::OutOfMemory(int rank, int size, std::string_view cause) {
  fmt::format_to_n(what_.data(), what_.size() - 1, "rank {} of {}: {}", rank, size, cause);
}

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
  } catch (const OutOfMemory& error) {
    return {rank, error.what(), std::make_exception_ptr(OutOfMemory(rank, size, error.what()))};
  } catch (const std::bad_alloc&) {
    return {rank, "out of memory", std::make_exception_ptr(OutOfMemory(rank, size, "out of memory"))};
  } catch (const std::exception& error) {
    return as(std::runtime_error(""), error.what());
  } catch (...) {
    return as(std::runtime_error(""), "an exception of unknown type");
  }
}

}  // namespace podm
