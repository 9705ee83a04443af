// The crossover is the number of threads from which on podm-home outruns podm on this machine, by the rows of
// an experiment. `podm mesh --algorithm auto` reads the stored crossover.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

/// Both algorithms on one number of threads.
struct CrossoverMeasurement {
  int threads = 0;
  double podm_cells_per_second = 0, podm_home_cells_per_second = 0;  ///< medians
  double ratio = 1;                        ///< median over rounds of cells per second of podm-home over podm
  std::array<double, 2> ratio_interval{};  ///< holds the median with ratio_coverage
  double ratio_coverage = 0;               ///< 0 for one round
  std::array<std::uint64_t, 2> rows{};     ///< numbers of rows of podm and podm-home
  static constexpr auto fields() {
    using C = CrossoverMeasurement;
    return std::tuple{field("threads", &C::threads),
                      field("podm_cells_per_second", &C::podm_cells_per_second),
                      field("podm_home_cells_per_second", &C::podm_home_cells_per_second),
                      field("ratio", &C::ratio),
                      field("ratio_interval", &C::ratio_interval),
                      field("ratio_coverage", &C::ratio_coverage),
                      field("rows", &C::rows)};
  }
};

/// The content of crossover.json.
struct Crossover {
  std::string schema;
  std::optional<int> threads;  ///< least number from which on podm-home is ahead; unset: none
  int measured_up_to = 0;
  MachineRecord machine;
  ProgramRecord podm;
  std::string experiment, trial, input;
  std::vector<CrossoverMeasurement> measurements;  ///< in ascending order of threads
  static constexpr auto fields() {
    using C = Crossover;
    return std::tuple{field("schema", &C::schema),
                      field("threads", &C::threads),
                      field("measured_up_to", &C::measured_up_to),
                      field("machine", &C::machine),
                      field("podm", &C::podm),
                      field("experiment", &C::experiment),
                      field("trial", &C::trial),
                      field("input", &C::input),
                      field("measurements", &C::measurements)};
  }
};

/// Computes the crossover from rows by trial, all of one machine and one mesher. At a number of threads
/// podm-home is ahead if the whole interval of the ratio of cells per second, podm-home over podm, lies above
/// 1 there and at every larger number of threads measured. The interval has the coverage that the rounds
/// allow. Only runs on real processors count: never virtual time, described machines, or more threads than
/// processors. The trial with the most cells per thread decides. Returns nothing if no trial has both
/// algorithms at one number of threads.
std::optional<Crossover> crossover_of(const std::vector<std::vector<Row>>& rows_of_trials);

/// Describes the crossover in a sentence without its full stop.
std::string tell_crossover(const Crossover& crossover);

}  // namespace podm::bench
