// The numbers that a file gives its nodes or elements: any numbers, each once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

/// Finds the item, counted from 0, that has a number.
class ItemNumbers {
 public:
  void add(std::uint64_t number) { numbers_.emplace_back(number, static_cast<VertexId>(numbers_.size())); }
  /// Must be called once, after the last add(). Throws InputError at `place` if a number occurs twice; `what`
  /// names the kind of number in the message.
  void finish(const MeshFile& file, const std::string& place, const char* what);
  /// Returns kNone for a number that no item has.
  VertexId find(std::uint64_t number) const;
  std::size_t size() const { return numbers_.size(); }

 private:
  std::vector<std::pair<std::uint64_t, VertexId>> numbers_;  // sorted by number once finished
  std::vector<VertexId> table_;                              // by number - first, if that is about as short
};

}  // namespace podm::verify
