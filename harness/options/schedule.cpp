#include "options/schedule.h"

#include <random>
#include <utility>

namespace podm::bench {
namespace {

// Shuffles by Fisher and Yates; std::shuffle differs between libraries. The bias of the remainder is below
// 2^-40.
void shuffle(std::vector<Turn>& turns, std::mt19937_64& generator) {
  for (std::size_t i = turns.size(); i > 1; --i) std::swap(turns[i - 1], turns[generator() % i]);
}

// Appends rounds until one is empty.
void append_rounds(const std::vector<Trial>& trials, int Trial::*count, bool is_warmup,
                   std::mt19937_64& generator, std::vector<Turn>& turns) {
  for (int repeat = 1;; ++repeat) {
    std::vector<Turn> round;
    for (std::size_t trial = 0; trial < trials.size(); ++trial)
      if (trials[trial].*count >= repeat) round.push_back({trial, repeat, is_warmup});
    if (round.empty()) return;
    shuffle(round, generator);
    turns.insert(turns.end(), round.begin(), round.end());
  }
}

}  // namespace

std::vector<Turn> schedule(const std::vector<Trial>& trials, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::vector<Turn> turns;
  append_rounds(trials, &Trial::warmups, true, generator, turns);
  append_rounds(trials, &Trial::repeats, false, generator, turns);
  return turns;
}

}  // namespace podm::bench
