// The keys of options that the harness treats in a way of its own.
#pragma once

namespace podm::bench {

/// The key of the mesher: podm, the default, or a folder of harness/peers.
inline constexpr const char *kMesher = "mesher", *kPodm = "podm";
/// The key that requests the schedule of the leaves. Its file belongs to the trial.
inline constexpr const char* kSchedule = "schedule";
/// The key of a trial that measures the machine and makes no mesh, and the key's only value.
inline constexpr const char *kMeasure = "measure", *kMemoryLatency = "memory_latency";
/// The key that runs this number of processes of the trial at the same time, each bound to a processor of its
/// own.
inline constexpr const char* kCopies = "copies";
/// The keys of two checks of a mesh: it equals the replay of its operations, and it satisfies the fidelity
/// claim of podm-verify (it follows the image closely).
inline constexpr const char *kReplay = "replay", *kFidelity = "fidelity";
/// The key that measures how far the lines of image and mesh, where three or more labels meet, are from each
/// other, also in meshes that do not promise lines.
inline constexpr const char* kLineDistances = "line_distances";
/// The key that hands the mesh to a finite-element solver: harness/solvers/README.md.
inline constexpr const char* kSolve = "solve";
/// The key that scales the number of a phantom's voxels with the number of threads.
inline constexpr const char* kImageGrows = "image_grows";
/// The keys of a trial that podm-mpi runs: the number of ranks, the carrier of their messages, and the
/// modelled network between ranks of one process, "MICROSECONDS,GB_PER_S".
inline constexpr const char *kRanks = "ranks", *kCarrier = "carrier", *kMpi = "mpi",
                            *kInProcess = "in-process", *kNetwork = "network";
/// The key of the target number of cells. The harness finds a radius for it once: radii.h.
inline constexpr const char* kTargetElements = "target_elements";

/// A length that a trial gives in voxels, because its images may have voxels of different sizes. The harness
/// passes it to the mesher in millimetres: preparation.h.
struct LengthInVoxels {
  const char *key, *key_in_mm;
};
inline constexpr LengthInVoxels kLengthsInVoxels[] = {{"smooth_voxels", "smooth"},
                                                      {"delta_voxels", "delta_mm"}};

/// The key of a trial's source of counters: the kernel (the default), cachegrind, or likwid with a group of
/// events.
inline constexpr const char *kCounters = "counters", *kPerfEvent = "perf_event", *kCachegrind = "cachegrind",
                            *kLikwid = "likwid:";

}  // namespace podm::bench
