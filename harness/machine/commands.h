// The commands of podm-bench that measure the machine. Each returns the exit code; all throw InputError.
#pragma once

#include <string>

namespace podm::bench {

/// Measures a load from each level of memory (memory_levels.h) and writes it as one line of JSON to the file,
/// or prints it where `record_path` is empty.
int latency(const std::string& record_path);

/// Prints what identifies this machine and a probe of its speed, as one line of JSON or for people.
int show_machine(bool as_json);

}  // namespace podm::bench
