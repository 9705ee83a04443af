#include "gate/gate_evidence.h"

#include <fmt/format.h>

#include "gate/simulated_machine.h"
#include "rows/binomial.h"
#include "rows/order_statistics.h"

namespace podm::bench {
namespace {

constexpr std::uint64_t kFirstSeed = 1'000'000;  // seeds of the simulated machines start here

std::optional<double> median_if_any(const std::vector<double>& samples) {
  return samples.empty() ? std::nullopt : std::optional(median(samples));
}

// Sets the counts. The other members of `tries` describe what was tried.
GateTries counted(GateTries tries, const std::vector<Slowdown>& answers) {
  std::vector<double> rounds, rounds_for_an_answer;
  for (const Slowdown& slowdown : answers) {
    tries.slower += slowdown.answer == Answer::kSlower;
    tries.not_slower += slowdown.answer == Answer::kNotSlower;
    tries.not_resolved += slowdown.answer == Answer::kNotResolved;
    rounds.push_back(slowdown.num_rounds);
    if (slowdown.answer == Answer::kNotResolved)
      rounds_for_an_answer.push_back(slowdown.rounds_for_an_answer());
  }
  tries.tries = static_cast<int>(answers.size());
  tries.median_rounds = median_if_any(rounds);
  tries.rounds_for_an_answer = median_if_any(rounds_for_an_answer);
  return tries;
}

void add_interval(GateTries& tries) {
  const ShareInterval interval = clopper_pearson(tries.slower, tries.tries);
  tries.slower_share_low = interval.low;
  tries.slower_share_high = interval.high;
}

// Returns the pairs of the base and the head with the planted slowdown.
std::vector<Round> pairs_of(const std::vector<GateRound>& rounds, int planted_percent,
                            double GateProcess::*seconds) {
  std::vector<Round> pairs;
  for (const GateRound& round : rounds) {
    Round& pair = pairs.emplace_back();
    for (const GateProcess& process : round.processes) {
      if (!process.is_head) pair.base_s = process.*seconds;
      if (process.is_head && process.planted_percent == planted_percent) pair.head_s = process.*seconds;
    }
  }
  return pairs;
}

std::string text_of(const std::optional<double>& value) { return value ? fmt::format("{:.0f}", *value) : ""; }

// Returns the share of answers "slower" in percent, with its interval if it has one.
std::string share_of_slower(const GateTries& tries) {
  if (tries.tries == 0) return "";
  std::string text = fmt::format("{:.1f} %", 100.0 * tries.slower / tries.tries);
  if (tries.slower_share_low && tries.slower_share_high)
    text += fmt::format(" [{:.1f}, {:.1f}]", 100 * *tries.slower_share_low, 100 * *tries.slower_share_high);
  return text;
}

// Describes what was tried: "simulated, noise 2 %" or "measured, processor seconds, tries apart".
std::string name_of(const GateTries& tries) {
  std::string name = tries.basis;
  if (tries.noise_percent) name += fmt::format(", noise {} %", *tries.noise_percent);
  if (tries.clock) name += fmt::format(", {} seconds", *tries.clock);
  if (tries.starts) name += fmt::format(", tries {}", *tries.starts);
  return name;
}

}  // namespace

std::vector<Slowdown> replayed_answers(std::span<const Round> rounds, bool overlapping) {
  std::vector<Slowdown> answers;
  for (std::size_t start = 0; start < rounds.size();) {
    std::size_t next = start;
    const std::optional<Slowdown> answer =
        measure_slowdown([&] { return next < rounds.size() ? std::optional(rounds[next++]) : std::nullopt; });
    if (answer) answers.push_back(*answer);
    start = overlapping ? start + 1 : next;
  }
  return answers;
}

std::vector<GateTries> measured_tries(const std::vector<GateRound>& rounds) {
  std::vector<GateTries> all;
  for (const bool by_processor : {true, false}) {
    for (const bool overlapping : {false, true}) {
      for (const int percent : kPlantedPercent) {
        GateTries tries{.basis = "measured",
                        .clock = by_processor ? "processor" : "wall",
                        .starts = overlapping ? "overlapping" : "apart",
                        .planted_percent = percent};
        const auto pairs =
            pairs_of(rounds, percent, by_processor ? &GateProcess::cpu_s : &GateProcess::wall_s);
        tries = counted(tries, replayed_answers(pairs, overlapping));
        if (!overlapping) add_interval(tries);
        all.push_back(tries);
      }
    }
  }
  return all;
}

std::vector<GateTries> simulated_tries(int num_tries) {
  std::vector<GateTries> all;
  for (const double noise_percent : {2.0, 3.0, 4.5}) {
    for (const int percent : kPlantedPercent) {
      std::vector<Slowdown> answers;
      for (int i = 0; i < num_tries; ++i) {
        SimulatedMachine machine(kFirstSeed + static_cast<std::uint64_t>(i), noise_percent / 100);
        answers.push_back(*measure_slowdown([&] { return machine.round(1 + percent / 100.0); }));
      }
      all.push_back(counted(
          {.basis = "simulated", .noise_percent = noise_percent, .planted_percent = percent}, answers));
      add_interval(all.back());
    }
  }
  return all;
}

std::string table_of(const std::vector<GateTries>& tries) {
  std::string text =
      "| rounds | planted | tries | slower | not slower | not resolved | share of slower [95 %] "
      "| median rounds | rounds for an answer where not resolved |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const GateTries& row : tries)
    text += fmt::format("| {} | {} % | {} | {} | {} | {} | {} | {} | {} |\n", name_of(row),
                        row.planted_percent, row.tries, row.slower, row.not_slower, row.not_resolved,
                        share_of_slower(row), text_of(row.median_rounds), text_of(row.rounds_for_an_answer));
  return text;
}

}  // namespace podm::bench
