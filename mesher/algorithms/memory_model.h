// What a run takes of memory, bytes: the one place where such sizes stand. Limits rest on the most that each
// part takes, estimates on what whole runs were measured to take.
#pragma once

#include <cstdint>

#include "delaunay/mesh.h"
#include "podm/choices.h"
#include "podm/label_image.h"
#include "podm/limits.h"
#include "refine/poor_element_list.h"

namespace podm {

// ---- Estimates of a mesh that is not made yet ----

/// Peak of the process for each cell of the mesh that comes out, as measured, cells of the background and all
/// else included.
inline constexpr double kPeakBytesPerMeshCell = 110;
/// The peak of refinement, extraction and writing for each cell of the store, the background's among them:
/// 70 to 80 between meshes of 0.1, 0.5 and 2 million cells of eight segmentations.
inline constexpr double kPeakBytesPerStoredCell = 73;
/// Cells of the store, the background's among them, for each of the mesh. Measured: 1.7 of 36 thousand cells,
/// 1.39 of 0.25, 1.27 of 0.8, 1.13 of 5.1 million. Less than all these, so that what can be numbered is not
/// refused.
inline constexpr double kStoredCellsPerMeshCell = 1.1;
/// Of the feature transform: 0.6 of one organ, 1 to 2 of segmentations, 3 to 4 of small images full of
/// labels.
inline constexpr double kTransformBytesPerVoxel = 1;

// ---- Limits ----

/// Buffers of files, the record, code not yet touched.
inline constexpr std::uint64_t kBytesOfOutput = 6 << 20;
/// The strength of a voxel, and its place in a list while it is found.
inline constexpr std::uint64_t kBytesPerSmoothedVoxel = 4;
/// A cell of a store that is full takes itself, a quarter of a vertex at most, the entries of a list that is
/// due for cleaning, and what extraction takes more.
inline constexpr std::uint64_t kBytesPerStoredCell =
    sizeof(Cell) + sizeof(Vertex) / 4 + PoorElementList::kGrowth * sizeof(PoorElementList::Entry) + 4;
/// A cube of the octree takes the first, leaf or gap, and a leaf the second more: its place in the queue, its
/// list of cells with some entries. While the octree is built each cube takes less than both together.
inline constexpr std::uint64_t kBytesPerCube = 32, kBytesPerLeaf = 160;
/// Leaves of a size that was asked for may take so much of the memory of a run; the mesh has the rest.
inline constexpr double kMostMemoryOfLeaves = 0.5;

/// What workers that are threads take, and what the allocator holds back of theirs.
std::uint64_t bytes_of_threads(std::uint64_t threads);
/// What the feature transform will take, or the most that it can where that is little of the limit.
std::uint64_t transform_bytes(const LabelImage& image, std::uint64_t limit_bytes, int threads);
/// What a run may take beside image and transform: as asked for, else all the machine has.
std::uint64_t memory_of_run(const Limits& limits);
/// The most cells for which a store, its workers and their lists stay within so many bytes.
std::uint64_t cell_capacity(std::uint64_t bytes, std::uint64_t num_workers, Executor executor);

}  // namespace podm
