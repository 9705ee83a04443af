// The options of `podm mesh` that an experiment sets, and the product of those given as arrays.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runtime/toml_section.h"

namespace podm::bench {

/// Which program makes the mesh: podm, the default, or a folder of harness/peers.
inline constexpr const char *kMesher = "mesher", *kPodm = "podm";
/// The key that asks for the schedule of the leaves; its file is the trial's own.
inline constexpr const char* kSchedule = "schedule";
/// The key of a trial that makes no mesh but measures the machine, and what it measures.
inline constexpr const char *kMeasure = "measure", *kMemoryLatency = "memory_latency";
/// The key that runs so many processes of the trial at the same time, each on a processor of its own.
inline constexpr const char* kCopies = "copies";
/// The keys of what is asked of a mesh that is made: to equal the replay of its operations, and to follow the
/// image closely, a claim of podm-verify.
inline constexpr const char *kReplay = "replay", *kFidelity = "fidelity";
/// The key that hands the mesh to a finite-element solver: harness/solvers/README.md.
inline constexpr const char* kSolve = "solve";
/// The key that has a phantom's voxels grow with the threads.
inline constexpr const char* kImageGrows = "image_grows";
/// The keys of a trial that podm-mpi runs: the number of its ranks, who carries what they say, and between
/// ranks of one process the modelled network, "MICROSECONDS,GB_PER_S".
inline constexpr const char *kRanks = "ranks", *kCarrier = "carrier", *kMpi = "mpi",
                            *kInProcess = "in-process", *kNetwork = "network";
/// The key of the number of cells aimed at, by a radius that is found once: radii.h.
inline constexpr const char* kTargetElements = "target_elements";

/// The key of a trial that says who counts: the kernel, the default, or one of the two.
inline constexpr const char *kCounters = "counters", *kPerfEvent = "perf_event", *kCachegrind = "cachegrind",
                            *kLikwid = "likwid:";

/// One member of the product.
struct Variant {
  std::string suffix;              ///< ",key=value" of each key that the file gives as an array
  nlohmann::ordered_json options;  ///< by key of the experiment's file; `threads` is always there
};

/// The product of the options in `section`, the first of the table in experiments/README.md slowest. A
/// topology is a file relative to `folder`.
std::vector<Variant> read_matrix(TomlSection& section, const std::string& folder);

/// Options are written as `podm mesh` takes them: radius_mm = 2 is "--radius", "2"; true is the bare option,
/// false none. Without those that are the harness's business: the keys above but the last, and kCounters.
std::vector<std::string> mesher_arguments(const nlohmann::ordered_json& options);

/// `value` as it stands in the name of a trial, made of letters, digits and . _ -
std::string in_name(const nlohmann::ordered_json& value);

}  // namespace podm::bench
