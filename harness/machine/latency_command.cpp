#include <fmt/format.h>

#include "machine/commands.h"
#include "machine/memory_levels.h"
#include "rows/codec.h"
#include "rows/results_file.h"

namespace podm::bench {

int latency(const std::string& record_path) {
  const std::string line = to_json(measure_memory_levels()).dump() + "\n";
  if (record_path.empty())
    fmt::print("{}", line);
  else
    write_file(record_path, line);
  return 0;
}

}  // namespace podm::bench
