// The leaf grid and the schedule of a run that refined an octree's leaves one by one (PDR, PDR.PODM).
//
// The file is JSON lines. The first line is the grid:
//   {"schema": "podm-schedule/1", "algorithm": "pdr-podm", "mesh_to_grid": [12 numbers, row-major 3x4],
//    "leaves": [[i, j, k, side], ...]}
// A leaf is the cube [i, i+side) x [j, j+side) x [k, k+side) of grid coordinates. Its numbers are integers,
// and side is a power of two. mesh_to_grid maps the coordinates of the mesh file to grid coordinates. One
// line follows for every time that a leaf was active:
//   {"leaf": 17, "node": 0, "begin_s": 0.125, "end_s": 0.25, "operations": 8123, "deferred": 2,
//    "touched_leaves": [16, 17, 18]}
// touched_leaves are the leaves that held a vertex which one of the operations locked.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace podm::verify {

struct Leaf {
  std::array<std::int64_t, 3> corner{};
  std::int64_t side = 1;
};

struct Activation {
  std::uint32_t leaf = 0, node = 0;
  double begin_s = 0, end_s = 0;
  std::uint64_t operations = 0, deferred = 0;
  std::vector<std::uint32_t> touched_leaves;
};

struct Schedule {
  std::string path, algorithm;
  std::array<double, 12> mesh_to_grid{};
  std::vector<Leaf> leaves;
  std::vector<Activation> activations;
};

/// Throws InputError with file, line and fault.
Schedule read_schedule(const std::string& path);

}  // namespace podm::verify
