// From how many threads on PDR.PODM outruns PODM on this machine, by the rows of an experiment. `podm mesh
// --algorithm auto` reads what is stored of it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace podm::bench {

/// What rows say, by trial, all of one machine and one mesher. `threads` is the least number from which on
/// PDR.PODM makes more cells a second than PODM, with evidence (95 % interval of the ratio of medians), on
/// every number measured; null: on none up to `measured_up_to`. Only what really ran decides, never virtual
/// time, described machines or more threads than processors. Of several trials that of the most cells a
/// thread decides. Null where none has both algorithms at one number of threads.
nlohmann::ordered_json crossover_of(const std::vector<std::vector<nlohmann::ordered_json>>& rows_of_trials);

/// The same as a sentence without its end.
std::string tell_crossover(const nlohmann::ordered_json& crossover);

}  // namespace podm::bench
