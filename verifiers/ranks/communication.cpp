#include "ranks/communication.h"

#include <fmt/format.h>

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

void expect_agreement(Communication& ranks, const std::vector<Fact>& facts) {
  std::vector<std::string> own;
  for (const auto& [name, text] : facts) own.push_back(text);
  const std::vector<std::vector<std::string>> all = gather(ranks, own);
  for (std::size_t rank = 1; rank < all.size(); ++rank)
    for (std::size_t i = 0; i < facts.size(); ++i)
      if (all[rank].at(i) != all[0].at(i))
        throw RefusedByAll(fmt::format("rank {} of {} does not have the {} of rank 0: {}, not {}", rank,
                                       all.size(), facts[i].first, all[rank][i], all[0][i]));
}

}  // namespace podm::verify
