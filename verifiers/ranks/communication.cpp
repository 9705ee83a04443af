#include "ranks/communication.h"

#include <numeric>

namespace podm::verify {

std::uint64_t sum_over(Communication& ranks, std::uint64_t value) {
  const std::vector<std::uint64_t> values = gather(ranks, value);
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

void do_on_all(Communication& ranks, const std::function<void()>& action) {
  std::string fault;
  try {
    action();
  } catch (const InputError& error) {
    fault = error.what();
  }
  for (const std::string& text : gather(ranks, fault))
    if (!text.empty()) throw RefusedByAll(text);
}

}  // namespace podm::verify
