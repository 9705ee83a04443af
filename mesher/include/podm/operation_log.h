// The linearization log: every committed operation with a sequence number taken while its locks were held.
// Operations with a common vertex have numbers in the order of their commits (delaunay/commit_order.h). One
// thread that replays all operations by number (podm replay) must get a bitwise equal mesh. This proves that
// a run of many workers equals a serial run.
//
// On ranks that share no memory each rank has its own log, with its own vertex numbers. The log also holds
// the vertices that the rank learns from other ranks. Sequence numbers include the step; all ranks take steps
// together. Therefore the logs of all ranks, step by step, are one serial run (merge_logs.h).
//
// The file: "podmlog1", then batches (two 32-bit counts, that many operations, that many removed vertices in
// the order of the operations), not sorted by sequence; two zero counts; then one JSON object to the end.
// Numbers are little-endian.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// The kind of an entry that is not an operation: a vertex got another id.
inline constexpr std::uint32_t kMovedVertex = 0;

/// Kinds of entries that are not operations. They log what a rank learns from other ranks between its own
/// operations. kReceivedInsertion plus a VertexKind: a vertex exists. kReceivedRemoval: the removed vertex is
/// gone. kSeed plus a VertexKind, in the first step: a vertex that the rank computed by itself; other ranks
/// may have logged the same one.
inline constexpr std::uint32_t kReceivedInsertion = 1u << 8, kReceivedRemoval = 1u << 9, kSeed = 1u << 10;

/// The sides of a flat box that a vertex is on are in the bits of its kind from this one on.
inline constexpr unsigned kSidesInLog = 16;

/// The high bits of a sequence number are the step, from 0. A run on one machine has only step 0.
inline constexpr unsigned kBitsInStep = 40;
inline std::uint64_t step_of(std::uint64_t sequence) { return sequence >> kBitsInStep; }
/// Returns "operation 5", or "operation 5 of step 3" unless the step is the first.
std::string operation_text(std::uint64_t sequence);

/// An inserted isosurface point or circumcenter together with the removed vertices. Or a new id of a vertex:
/// the removed id is called `vertex` from now on.
struct LoggedOperation {
  std::uint64_t sequence = 0;     ///< order of the commits of a run, with gaps
  std::array<double, 3> point{};  ///< mm, working frame
  std::uint32_t vertex = 0;       ///< id of the inserted vertex; ids of removed vertices are reused
  std::uint32_t worker = 0;
  std::uint32_t kind = 0;  ///< a VertexKind, or one of the kinds above
  std::uint32_t num_removed = 0;
};
static_assert(sizeof(LoggedOperation) == 48);

struct OperationBatch {
  std::vector<LoggedOperation> operations;
  std::vector<std::uint32_t> removed;  ///< vertex ids, num_removed per operation
};

/// The part of space of one of several ranks, in cubes of a grid (distributed/cubes.h).
struct CubesOfRank {
  using Run = std::array<std::uint32_t, 2>;  ///< numbers of the first and the last of consecutive cubes
  std::array<double, 6> grid{};              ///< low and high corner of the covered box, mm, working frame
  double side_mm = 0;                        ///< side of a cube
  std::vector<Run> block;  ///< cubes of this rank: a cell belongs to the rank that has its least vertex
  std::vector<Run> known;  ///< cubes of which the rank has all vertices at the end
};

/// The description of the run in a log.
struct OperationLogHead {
  std::array<double, 6> box{};  ///< low and high corner of the virtual box, mm, working frame
  std::string image_sha256;     ///< label_image_sha256() of the image as meshed
  std::string space;            ///< space of the hashed coordinates: "RAS", "LPS" or "voxel"
  std::string mesh_sha256;      ///< canonical, of the mesh as written; empty if `mesh_hash` is set
  std::string mesh_hash = {};   ///< mesh_hash_text() of the whole mesh, if ranks made it; otherwise empty
  int rank = 0, num_ranks = 1;  ///< rank of this log, and number of ranks
  double smoothing_mm = 0;      ///< width by which interfaces were smoothed
  bool is_box_flat = false;     ///< LabelImage::is_box_flat of the image as meshed
  std::optional<CubesOfRank> cubes = {};  ///< set if there are several ranks
};

struct OperationLog {
  OperationLogHead head;
  OperationBatch all;  ///< sorted by sequence
};

/// Writes a log to a temporary file and renames the file when it is finished. Otherwise no file remains.
class OperationLogWriter {
 public:
  /// Throws InputError if the file cannot be created.
  explicit OperationLogWriter(const std::string& path);
  ~OperationLogWriter();
  OperationLogWriter(const OperationLogWriter&) = delete;
  OperationLogWriter& operator=(const OperationLogWriter&) = delete;

  /// Must be called between operations. Later operations of this rank follow all operations of any rank in
  /// earlier steps.
  void begin_step();
  /// The least number of an operation that begins now. Only begin_step(), set_least_sequence() and restart()
  /// change it.
  std::uint64_t least_sequence() const { return least_sequence_; }
  /// Must be called between operations.
  void set_least_sequence(std::uint64_t least) { least_sequence_ = least; }
  void append(const OperationBatch& batch);
  /// Removes all operations, for a run that starts again.
  void restart();
  /// Writes everything to the disk, still under the temporary name. Throws InputError if the file cannot be
  /// written completely.
  void finish(const OperationLogHead& head);
  /// Gives a finished log its name. Throws InputError if the file cannot be renamed.
  void publish();

 private:
  struct File;
  std::unique_ptr<File> file_;
  std::uint64_t least_sequence_ = 0;
};

/// Returns a hash of the voxels of the selected labels and of the affine, on which a mesh depends.
std::string label_image_sha256(const LabelImage& image);

/// Throws InputError that names file, place and fault.
OperationLog read_operation_log(const std::string& path);

}  // namespace podm
