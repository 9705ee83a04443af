#include <fmt/format.h>

#include "machine/commands.h"
#include "machine/sharing.h"
#include "rows/codec.h"

namespace podm::bench {

int sharing() {
  fmt::print("{}\n", to_json(measure_sharing()).dump());
  return 0;
}

}  // namespace podm::bench
