// The linearization log: every committed operation with a sequence number taken while its locks were held.
// Played in that order on one thread (podm replay), it must give the same mesh to the bit: the proof that a
// run of many workers equals a serial one.
//
// On ranks that share no memory each has a log of its own, with the numbers of its own vertices. What it
// learns of others' vertices is logged, too. Sequence numbers count steps, too, which all ranks take
// together: so the logs of all ranks, step by step, are one serial run (merge_logs.h).
//
// The file: "podmlog1", then batches (two 32-bit counts, that many operations, that many vertices removed, in
// the operations' order), in no order of sequence; two zero counts; then one JSON object to the end. Numbers
// are little-endian.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// The kind of an entry that is no operation: a vertex got another id.
inline constexpr std::uint32_t kMovedVertex = 0;

/// Kinds of entries that are no operations, but tell what a rank learns from others between its own: there is
/// a vertex, whose VertexKind is added to the first, or one is gone, the one removed.
inline constexpr std::uint32_t kLearntVertex = 1u << 8, kForgottenVertex = 1u << 9;

/// The high bits of a sequence number are the step, from 0; the first is all of a run on one machine.
inline constexpr unsigned kBitsInStep = 40;
inline std::uint64_t step_of(std::uint64_t sequence) { return sequence >> kBitsInStep; }
/// "operation 5", or "operation 5 of step 3" unless it is the first.
std::string operation_text(std::uint64_t sequence);

/// An isosurface point or circumcentre inserted, together with the removal of vertices. Or a vertex that gets
/// another id: the one removed is called `vertex` from now on.
struct LoggedOperation {
  std::uint64_t sequence = 0;     ///< order of the commits of a run; gaps are allowed
  std::array<double, 3> point{};  ///< mm, working frame
  std::uint32_t vertex = 0;       ///< id of the inserted vertex; ids of removed vertices are used again
  std::uint32_t worker = 0;
  std::uint32_t kind = 0;  ///< a VertexKind, or kMovedVertex
  std::uint32_t num_removed = 0;
};
static_assert(sizeof(LoggedOperation) == 48);

struct OperationBatch {
  std::vector<LoggedOperation> operations;
  std::vector<std::uint32_t> removed;  ///< vertex ids, num_removed for each operation
};

/// What a log tells of its run besides operations.
struct OperationLogHead {
  std::array<double, 6> box{};  ///< low and high corner of the virtual box, as above
  std::string image_sha256;     ///< label_image_sha256() of the image as meshed
  std::string space;            ///< of the coordinates hashed: "RAS", "LPS" or "voxel"
  std::string mesh_sha256;      ///< canonical, of the mesh as written; empty: see the next
  std::string mesh_hash = {};   ///< of a mesh that ranks made, mesh_hash_text() of the whole; else empty
  int rank = 0, num_ranks = 1;  ///< whose log of how many
  double smoothing_mm = 0;      ///< by which interfaces were smoothed
};

struct OperationLog {
  OperationLogHead head;
  OperationBatch all;  ///< in sequence
};

/// Writes a log aside and gives it its name when it is finished; else nothing is left.
class OperationLogWriter {
 public:
  /// Throws InputError when the file cannot be made.
  explicit OperationLogWriter(const std::string& path);
  ~OperationLogWriter();
  OperationLogWriter(const OperationLogWriter&) = delete;
  OperationLogWriter& operator=(const OperationLogWriter&) = delete;

  /// Between operations. What comes now comes after what any rank has done in earlier steps.
  void begin_step();
  /// Any worker, any time.
  std::uint64_t next_sequence() { return sequence_.fetch_add(1, std::memory_order_relaxed); }
  void append(const OperationBatch& batch);
  /// Forgets all operations, for a run that starts again.
  void restart();
  /// Brings all to the disk, still aside. Throws InputError when the file cannot be written whole.
  void finish(const OperationLogHead& head);
  /// Gives a finished log its name. Throws InputError when it cannot have it.
  void publish();

 private:
  struct File;
  std::unique_ptr<File> file_;
  // Relaxed: whoever takes the number of a later operation on the same vertices holds their locks, so it
  // comes after the earlier holder's release, and fetch_add keeps that order.
  std::atomic<std::uint64_t> sequence_ = 0;
};

/// Hashes what a mesh depends on: the voxels of the selected labels, and the affine.
std::string label_image_sha256(const LabelImage& image);

/// Throws InputError with file, place and fault.
OperationLog read_operation_log(const std::string& path);

}  // namespace podm
