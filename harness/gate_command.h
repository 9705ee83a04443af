// `podm-bench gate` and `podm-bench compare` on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace podm::bench {

/// Each adds its command; when that is chosen, it runs inside parse() and leaves its exit code. They throw
/// InputError. `podm` is the mesher to judge where none is named.
void add_gate(CLI::App& program, const std::string& podm, int& exit_code);
void add_compare(CLI::App& program, int& exit_code);

}  // namespace podm::bench
