// Commands of podm-bench that measure the machine. Each returns the exit code; all throw InputError.
#pragma once

#include <string>

namespace podm::bench {

/// Measures the latency of loads from each level of memory (memory_levels.h). Writes it as one line of JSON
/// to the file, or prints it if `record_path` is empty.
int latency(const std::string& record_path);

/// Measures the costs of cache lines and new pages that two threads share (sharing.h), and prints them as one
/// line of JSON.
int sharing();

/// Prints the identity of this machine and a probe of its speed, as one line of JSON or as text.
int show_machine(bool as_json);

}  // namespace podm::bench
