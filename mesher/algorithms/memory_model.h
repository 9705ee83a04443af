// The memory of a run, bytes: the only place for such sizes. Limits rest on the most that each part takes,
// estimates on measurements of whole runs.
#pragma once

#include <cstdint>

#include "delaunay/mesh.h"
#include "image/image_by_bricks.h"
#include "podm/choices.h"
#include "podm/label_image.h"
#include "podm/limits.h"
#include "refine/poor_element_list.h"

namespace podm {

// ---- Estimates of a mesh that is not made yet ----

/// The measured peak of the process per cell of the resulting mesh, background cells and everything else
/// included.
inline constexpr double kPeakBytesPerMeshCell = 110;
/// The peak of refinement, extraction and writing per cell of the store, background cells included: 70 to 80
/// between meshes of 0.1, 0.5 and 2 million cells of eight segmentations.
inline constexpr double kPeakBytesPerStoredCell = 73;
/// Cells of the store, background cells included, per cell of the mesh. Measured: 1.7 for 36 thousand cells,
/// 1.39 for 0.25 million, 1.27 for 0.8 million, 1.13 for 5.1 million. The constant is less than all of them,
/// so that no mesh is refused whose cells can be numbered.
inline constexpr double kStoredCellsPerMeshCell = 1.1;
/// The feature transform takes 0.6 for one organ, 1 to 2 for segmentations, 3 to 4 for small images full of
/// labels.
inline constexpr double kTransformBytesPerVoxel = 1;
/// The transform of an image whose voxels stay in the file takes its table and its masks, and 12 lines of 64
/// bytes for each brick with surface voxels and the near bricks around it. A rank reads the pages of its
/// block, of its share of the predicted work, and of covers and zones, as if it had kSharesOfRank blocks, and
/// those in which its sparse seeds lie. Each of 8 ranks read an image of 60 pages as a whole, and
/// each of 4 ranks almost all of 702 pages.
inline constexpr double kBytesPerBrick = 16, kBytesPerMixedBrick = 12 * 64;
inline constexpr double kSharesOfRank = 3, kPagesOfSeeds = 1000, kBricksPerPage = 16 * 16 * 16;

// ---- Limits ----

/// Buffers of files, the record, and code that has not been touched yet.
inline constexpr std::uint64_t kBytesOfOutput = 6 << 20;
/// The weight of a voxel, and its entry in a list during the search.
inline constexpr std::uint64_t kBytesPerSmoothedVoxel = 4;
/// A cell of a full store takes itself, at most a quarter of a vertex, the entries of a list that is due for
/// cleaning, and the additional memory of extraction.
inline constexpr std::uint64_t kBytesPerStoredCell =
    sizeof(Cell) + sizeof(Vertex) / 4 + PoorElementList::kGrowth * sizeof(PoorElementList::Entry) + 4;
/// The stamp of a quarter of a vertex, in a run with a log.
inline constexpr std::uint64_t kStampBytesPerStoredCell = sizeof(std::uint64_t) / 4;
/// Each cube of the octree, leaf or gap, takes kBytesPerCube. A leaf takes kBytesPerLeaf in addition: its
/// place in the queue, and its list of cells with some entries. While the octree is built each cube takes
/// less than both together.
inline constexpr std::uint64_t kBytesPerCube = 32, kBytesPerLeaf = 160;
/// Leaves of a requested size may take this fraction of the memory of a run; the mesh has the rest.
inline constexpr double kMostMemoryOfLeaves = 0.5;

/// Returns the bytes that workers on threads take, and that the allocator holds back for them.
std::uint64_t bytes_of_threads(std::uint64_t threads);
/// Returns an estimate of the transform's bytes if the voxels stay in the file and each of `num_ranks` ranks
/// has a transform of its own.
std::uint64_t bytes_of_bricks(const ImageByBricks& image, int num_ranks);
/// Returns the bytes that the feature transform will take, or the most it can take if that is a small part of
/// the limit. `num_ranks` as in bytes_of_bricks().
std::uint64_t transform_bytes(const LabelImage& image, std::uint64_t limit_bytes, int threads, int num_ranks);
/// Returns the bytes that a run may take in addition to image and transform: the requested limit, otherwise
/// all memory of the machine.
std::uint64_t memory_of_run(const Limits& limits);
/// Returns the largest number of cells for which a store, its workers and their lists stay within `bytes`.
/// With a log, every vertex also has a stamp (delaunay/commit_order.h).
std::uint64_t cell_capacity(std::uint64_t bytes, std::uint64_t num_workers, Executor executor, bool has_log);

}  // namespace podm
