// A row is the JSON line that a trial leaves, described key by key in results/README.md. The fields() of
// these structs are the one definition for writing and reading rows. Other programs read rows by
// results/schema/podm-bench-row.schema.json; rows/tests/test_row_schema.cpp checks that it agrees with the
// fields.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "rows/machine_record.h"
#include "rows/mesher_record.h"

namespace podm::bench {

inline constexpr int kRowSchema = 4;

/// The origin of a row's numbers. A row is simulated if its workers or its caches are simulated, or if its
/// machine is a described one. A claim may use kAny.
enum class Basis { kMeasured, kSimulated, kAny };
constexpr std::array<const char*, 3> names_of(Basis) { return {"measured", "simulated", "any"}; }

enum class Status {
  kOk,
  kUnmet,        ///< there is a mesh, but a guarantee or limit is unmet or a claim is not proved
  kFailed,       ///< there is no mesh, or no record of it
  kTimedOut,     ///< the process was killed at its time limit
  kInterrupted,  ///< the user ended it, and all trials after it
  kSkipped,      ///< it cannot run here and need not; no file has such a row
};
constexpr std::array<const char*, 6> names_of(Status) {
  return {"ok", "unmet", "failed", "timed_out", "interrupted", "skipped"};
}

using ImageSize = std::array<int, 3>;                ///< voxels along each axis
using Number = std::variant<std::uint64_t, double>;  ///< in the type in which it was counted

double as_double(const Number& number);

/// A count by perf_event_open(2), valgrind or likwid.
struct Counter {
  Number value;
  std::string source;                   ///< the program that counted
  std::optional<double> running_share;  ///< counted share of the time, if `value` is scaled up
  static constexpr auto fields() { return PODM_FIELDS(Counter, value, source, (running_share)); }
};
using Counters = ByName<std::variant<Counter, Unavailable>>;

/// The radius for a target number of cells: trials/radii.h.
struct ResolvedRadius {
  std::uint64_t target_elements = 0;  ///< the target
  double radius_mm = 0, delta_mm = 0;
  std::uint64_t cells = 0;              ///< cells of the mesh that is the evidence
  std::optional<std::uint64_t> meshes;  ///< number of meshes made to find it; unset if not reported
  double seconds = 0;                   ///< time spent to find it
  std::string key;                      ///< of its line in radii.jsonl
  static constexpr auto fields() {
    return PODM_FIELDS(ResolvedRadius, target_elements, radius_mm, delta_mm, cells, meshes, seconds, key);
  }
  bool operator==(const ResolvedRadius&) const = default;
};

/// The image of a trial.
struct InputRecord {
  std::string name;                                        ///< name in the experiment
  std::string path;                                        ///< the file that was read
  std::optional<std::string> sha256;                       ///< hash of its bytes
  std::optional<std::vector<std::vector<double>>> affine;  ///< rows of the matrix from voxels to mm
  std::optional<ImageSize> size;
  static constexpr auto fields() { return PODM_FIELDS(InputRecord, name, path, sha256, (affine), size); }
};

/// The result of replaying a mesh's operation log sequentially: the mesh is "equal", "differs", or the replay
/// "failed: why".
struct Replay {
  enum class End { kEqual, kDiffers, kFailed };
  End end = End::kEqual;
  std::string why;  ///< the reason of kFailed

  std::string text() const;
  bool operator==(const Replay&) const = default;
};
template <>
struct Codec<Replay> {
  static Json write(const Replay& replay);
  static Replay read(const Json& json, const std::string& place);
};

/// The cost of conjugate gradients with one preconditioner: harness/solvers/README.md.
struct IterationsRecord {
  std::uint64_t iterations = 0;
  double smallest_eigenvalue = 0, largest_eigenvalue = 0;  ///< of the preconditioned matrix, estimated
  double setup_s = 0, seconds = 0;                         ///< of the preconditioner, and of the iterations
  static constexpr auto fields() {
    return PODM_FIELDS(IterationsRecord, iterations, smallest_eigenvalue, largest_eigenvalue, setup_s,
                       seconds);
  }
};

/// A system of equations on the mesh.
struct SystemRecord {
  std::uint64_t unknowns = 0;
  IterationsRecord jacobi, amg;  ///< by preconditioner: the diagonal, an algebraic multigrid
  static constexpr auto fields() { return PODM_FIELDS(SystemRecord, unknowns, jacobi, amg); }
};

/// The cost of the mesh for a solver.
struct SolveRecord {
  std::string solver;  ///< version and licence
  SystemRecord poisson, elasticity;
  static constexpr auto fields() { return PODM_FIELDS(SolveRecord, solver, poisson, elasticity); }
};

/// The entry of one of the processes that ran at the same time.
struct CopyRecord {
  int processor = 0;  ///< the processor that it ran on
  std::uint64_t cells = 0;
  ByName<double> phases_s;
  double refine_cells_per_second = 0;
  std::optional<double> cells_per_second;
  static constexpr auto fields() {
    return PODM_FIELDS(CopyRecord, processor, cells, phases_s, refine_cells_per_second, cells_per_second);
  }
};

/// The end of the mesher's process and its resources.
struct ProcessRecord {
  std::optional<int> exit_code, signal;  ///< unset if the process did not end in this way
  double timeout_s = 0;                  ///< the limit
  std::optional<double> memory_limit_gib;
  double wall_s = 0, user_s = 0, system_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  std::optional<double> bytes_per_cell_beyond_image;  ///< unset without a mesh
  Counters counters;
  static constexpr auto fields() {
    return PODM_FIELDS(ProcessRecord, exit_code, signal, timeout_s, memory_limit_gib, wall_s, user_s,
                       system_s, peak_rss_bytes, bytes_per_cell_beyond_image, counters);
  }
};

struct ProgramRecord {
  std::string sha256;                                                   ///< hash of its bytes
  std::string version;                                                  ///< the first line of its --version
  std::optional<std::variant<ByName<std::string>, Unavailable>> build;  ///< the lines "key: value" after it
  static constexpr auto fields() { return PODM_FIELDS(ProgramRecord, sha256, version, (build)); }
};

/// A mesher other than podm.
struct PeerRecord {
  std::string name, sha256, version;
  static constexpr auto fields() { return PODM_FIELDS(PeerRecord, name, sha256, version); }
};

struct ProgramRecords {
  static constexpr const char* kNone = "none";
  ProgramRecord podm;
  std::variant<ProgramRecord, std::string> podm_verify = kNone;  ///< kNone if meshes are not verified
  std::optional<PeerRecord> peer;
  std::optional<ProgramRecord> podm_mpi;  ///< the mesher on ranks; unset if it is not built
  static constexpr auto fields() {
    return PODM_FIELDS(ProgramRecords, podm, podm_verify, (peer), (podm_mpi));
  }
};

/// Limits of this process's control groups, as the kernel writes them, or "unavailable: why".
struct ControlGroupLimits {
  std::string cpu_max, cpuset, memory_max;
  static constexpr auto fields() { return PODM_FIELDS(ControlGroupLimits, cpu_max, cpuset, memory_max); }
};

struct Sources {
  std::string commit;
  bool dirty = false;  ///< tracked files differ from the commit
  static constexpr auto fields() { return PODM_FIELDS(Sources, commit, dirty); }
};

struct MemoryBytes {
  Count total = 0UL, available = 0UL;
  static constexpr auto fields() { return PODM_FIELDS(MemoryBytes, total, available); }
};

/// The machine with its state, and the build of this program. Texts may read "unavailable: why".
struct EnvironmentRecord : MachineRecord {
  std::string topology_sha256;  ///< HASH in topology-HASH.xml beside the rows
  std::string kernel, smt;
  ControlGroupLimits cgroup;
  ByName<std::string> libraries;  ///< versions by name
  std::string compiler, compiler_flags, build_type;
  std::variant<Sources, Unavailable> sources;
  std::variant<std::vector<double>, Unavailable> load_average;  ///< over 1, 5 and 15 minutes
  MemoryBytes memory_bytes;
  std::string governor, transparent_huge_pages, numa_balancing;
  std::optional<Probe> probe;              ///< at the start of the round; unset in simulated and older rows
  std::optional<Probe> probe_after;        ///< at the end of the round, if the speed moved
  std::optional<Measured> busy_elsewhere;  ///< mean number of processors that other work kept busy
  static constexpr auto fields() {
    return std::tuple_cat(
        MachineRecord::fields(),
        PODM_FIELDS(EnvironmentRecord, topology_sha256, kernel, smt, cgroup, libraries, compiler,
                    compiler_flags, build_type, sources, load_average, memory_bytes, governor,
                    transparent_huge_pages, numa_balancing, (probe), (probe_after), (busy_elsewhere)));
  }
};

/// The result of a trial when it has ended.
struct TrialOutcome {
  Status status = Status::kFailed;
  std::string reason;                                   ///< the reason of a status that is not kOk
  std::vector<std::string> command;                     ///< the arguments of the process
  std::optional<MeshRecord> mesh;                       ///< the mesher's record; unset without a mesh
  std::optional<MemoryLevelsRecord> measured;           ///< measurement of a trial that makes no mesh
  std::optional<Replay> replay;                         ///< unset if it was not requested
  std::optional<std::vector<CopyRecord>> side_by_side;  ///< unset if a single process ran
  std::optional<SolveRecord> solve;                     ///< unset if it was not requested or failed
  double preparation_s = 0, verification_s = 0;         ///< before the mesher starts and after it has ended
  std::string stderr_tail;                              ///< end of stderr of a trial that is not kOk
};

/// One line of a file of results.
struct Row : TrialOutcome {
  int schema = kRowSchema;
  std::string key;  ///< identifies the turn: TrialKeys
  std::string experiment, trial;
  int repeat = 1;  ///< number of the round, from 1; warm-ups and measured repeats are counted apart
  bool warmup = false;
  std::uint64_t order_seed = 0;  ///< seed of the schedule
  JsonPointer asked;             ///< the trial's options by the keys of experiments/*.toml
  Basis basis = Basis::kMeasured;
  std::optional<ResolvedRadius> resolved;
  InputRecord input;
  std::optional<std::uint64_t> mesh_bytes;  ///< size of the mesh file
  ProcessRecord process;
  double harness_s = 0;             ///< time that this program spent since the row before
  std::optional<bool> probe_moved;  ///< true if the machine's speed moved during the row's round
  ProgramRecords programs;
  EnvironmentRecord environment;

  /// The keys before the mesher's own keys, and the keys after them.
  static constexpr auto fields_before() {
    return PODM_FIELDS(Row, schema, key, experiment, trial, repeat, warmup, order_seed, status, reason, asked,
                       basis, command, resolved, input);
  }
  static constexpr auto fields_after() {
    return PODM_FIELDS(Row, replay, side_by_side, (solve), mesh_bytes, process, preparation_s, verification_s,
                       harness_s, stderr_tail, (probe_moved), programs, environment);
  }
};
/// Returns `asked`; an empty object if the row has none.
const Json& asked_of(const Row& row);
/// True if a row has a mesh, whether it met its guarantees or not.
inline bool is_finished(const Row& row) { return row.status == Status::kOk || row.status == Status::kUnmet; }

template <>
struct Codec<Row> {
  static Json write(const Row& row);
  static Row read(const Json& json, const std::string& place);
};

}  // namespace podm::bench
