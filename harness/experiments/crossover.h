// The crossover is the number of threads from which on PODM at home outruns PODM on this machine, by the rows
// of an experiment. `podm mesh --algorithm auto` reads what is stored of it.
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
  double ratio = 1;                        ///< cells a second of podm-home over podm, in the median of rounds
  std::array<double, 2> ratio_interval{};  ///< that holds it with ratio_coverage
  double ratio_coverage = 0;               ///< 0 of one round
  std::array<std::uint64_t, 2> rows{};     ///< how many of podm and podm-home
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

/// What is stored in crossover.json.
struct Crossover {
  std::string schema;
  std::optional<int> threads;  ///< the least number from which on podm-home is ahead; nothing: none is
  int measured_up_to = 0;
  MachineRecord machine;
  ProgramRecord podm;
  std::string experiment, trial, input;
  std::vector<CrossoverMeasurement> measurements;  ///< numbers of threads rise
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

/// What rows say, by trial, all of one machine and one mesher. PODM at home is ahead where it makes more
/// cells a second than PODM, in all of the interval of the ratio (with as much coverage as the rounds have),
/// on every number of threads measured from there on. Only what really ran decides, never virtual time,
/// described machines or more threads than processors. The trial of the most cells a thread decides. There is
/// none where no trial has both algorithms at one number of threads.
std::optional<Crossover> crossover_of(const std::vector<std::vector<Row>>& rows_of_trials);

/// Tells the crossover in a sentence without its end.
std::string tell_crossover(const Crossover& crossover);

}  // namespace podm::bench
