// The choices of a run. Each has one table of names, by which options are parsed, help is printed and records
// are written.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "podm/errors.h"

namespace podm {

/// Specialised for each choice: kAll, an array of pairs of a value and its name, in the order in which help
/// lists them.
template <class Choice>
struct Names;

template <class Choice>
concept Named = requires {
  Names<Choice>::kAll;
};

/// Throws InternalError for a value that no table has.
template <Named Choice>
std::string to_string(Choice choice) {
  for (const auto& [value, name] : Names<Choice>::kAll)
    if (value == choice) return name;
  throw InternalError("a choice without a name");
}

/// How the work is divided among threads. kPodm: anywhere, with locks. kPdrPodm: an initial mesh by PODM,
/// then leaf by leaf of an octree, each by a computing node of several threads. kPdr: leaf by leaf, one
/// thread each, without locks. kPodmHome: with locks, each computing node in its own block of space. kAuto:
/// kPodm, or kPodmHome where threads are pinned to several NUMA nodes.
enum class Algorithm { kAuto, kPodm, kPdr, kPdrPodm, kPodmHome };
template <>
struct Names<Algorithm> {
  static constexpr std::array kAll{std::pair{Algorithm::kAuto, "auto"}, std::pair{Algorithm::kPodm, "podm"},
                                   std::pair{Algorithm::kPdr, "pdr"},
                                   std::pair{Algorithm::kPdrPodm, "pdr-podm"},
                                   std::pair{Algorithm::kPodmHome, "podm-home"}};
};

/// What a worker does that finds a vertex locked by another; see workers/contention_manager.h.
enum class Contention { kAggressive, kRandom, kGlobal, kLocal };
template <>
struct Names<Contention> {
  static constexpr std::array kAll{
      std::pair{Contention::kAggressive, "aggressive"}, std::pair{Contention::kRandom, "random"},
      std::pair{Contention::kGlobal, "global"}, std::pair{Contention::kLocal, "local"}};
};

/// Whom a worker with cells to spare serves first: the one that has begged longest, or the nearest in the
/// machine; see workers/begging_list.h.
enum class Begging { kRandom, kHierarchical };
template <>
struct Names<Begging> {
  static constexpr std::array kAll{std::pair{Begging::kRandom, "random"},
                                   std::pair{Begging::kHierarchical, "hierarchical"}};
};

/// Who runs the workers: threads, or one core that plays them in virtual time (workers/virtual_time.h).
enum class Executor { kThreads, kVirtual };
template <>
struct Names<Executor> {
  static constexpr std::array kAll{std::pair{Executor::kThreads, "threads"},
                                   std::pair{Executor::kVirtual, "virtual"}};
};

/// What an attempt lasts in virtual time: 1 us, or by its work, in the proportions of a measured run. Both
/// are varied at random by half.
enum class VirtualCost { kUnit, kMeasured };
template <>
struct Names<VirtualCost> {
  static constexpr std::array kAll{std::pair{VirtualCost::kUnit, "unit"},
                                   std::pair{VirtualCost::kMeasured, "measured"}};
};

/// The frame of vertex coordinates, all in mm but `voxel` (continuous voxel indices).
enum class Space { kRas, kLps, kVoxel };
template <>
struct Names<Space> {
  static constexpr std::array kAll{std::pair{Space::kRas, "RAS"}, std::pair{Space::kLps, "LPS"},
                                   std::pair{Space::kVoxel, "voxel"}};
};

/// Of Gmsh's format: binary 4.1, or text 2.2, the newest that many solvers read.
enum class GmshVersion { k4_1, k2_2 };
template <>
struct Names<GmshVersion> {
  static constexpr std::array kAll{std::pair{GmshVersion::k4_1, "4.1"}, std::pair{GmshVersion::k2_2, "2.2"}};
};

/// By what optimisation makes cells better: replacing the cells around an edge or on both sides of facets,
/// moving a vertex, any cells that fill a cavity, the same with a new vertex, and giving a flat cell on an
/// interface to another label.
enum class OptimizationMeans { kFlips, kMoves, kSearches, kAddedVertices, kPeels };
template <>
struct Names<OptimizationMeans> {
  static constexpr std::array kAll{std::pair{OptimizationMeans::kFlips, "flips"},
                                   std::pair{OptimizationMeans::kMoves, "moves"},
                                   std::pair{OptimizationMeans::kSearches, "searches"},
                                   std::pair{OptimizationMeans::kAddedVertices, "added_vertices"},
                                   std::pair{OptimizationMeans::kPeels, "peels"}};
};

/// Why a cell stays beyond the bounds: two facets of the interface of two labels, or facets of two interfaces
/// where three labels meet, make the angle; all its vertices are on the isosurface; or none of these.
enum class OptimizationObstacle { kFrozenFacets, kJunction, kFrozenVertices, kOther };
template <>
struct Names<OptimizationObstacle> {
  static constexpr std::array kAll{std::pair{OptimizationObstacle::kFrozenFacets, "frozen_facets"},
                                   std::pair{OptimizationObstacle::kJunction, "junction"},
                                   std::pair{OptimizationObstacle::kFrozenVertices, "frozen_vertices"},
                                   std::pair{OptimizationObstacle::kOther, "other"}};
};

/// kNumberLimit: as many cells were made as have numbers, though memory was left.
enum class StopReason { kComplete, kCancelled, kElementLimit, kTimeLimit, kMemoryLimit, kNumberLimit };
template <>
struct Names<StopReason> {
  static constexpr std::array kAll{std::pair{StopReason::kComplete, "complete"},
                                   std::pair{StopReason::kCancelled, "cancelled"},
                                   std::pair{StopReason::kElementLimit, "element limit"},
                                   std::pair{StopReason::kTimeLimit, "time limit"},
                                   std::pair{StopReason::kMemoryLimit, "memory limit"},
                                   std::pair{StopReason::kNumberLimit, "limit of 2^30 cells in the store"}};
};

}  // namespace podm
