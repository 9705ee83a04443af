// podm serve: becomes a script, which runs this program for the page that it serves.
#include <nlohmann/json.hpp>

#include "cli/commands/commands.h"
#include "cli/processes/own_program.h"
#include "cli/processes/python_scripts.h"
#include "cli/reports/json_text.h"

namespace podm::cli {

int run(const ServeCommand& command) {
  const nlohmann::ordered_json request = {
      {"programs", folder_of_own_program().string()},
      {"port", command.port},
      {"browser", !command.without_browser},
      {"max_upload_mib", command.max_upload_mib},
      {"max_memory_gib", static_cast<double>(command.max_memory.bytes) / kBytesPerGib},
      {"max_seconds", command.max_seconds}};
  become_script("serve", json_line(request), "serve");
}

}  // namespace podm::cli
