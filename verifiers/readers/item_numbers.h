// Numbers that a file gives its nodes or elements: any, and each once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

/// Which item, counted from 0, has which number.
class ItemNumbers {
 public:
  void add(std::uint64_t number) { numbers_.emplace_back(number, static_cast<VertexId>(numbers_.size())); }
  /// Must be called once, after the last add(). Throws InputError at `place` if a number is there twice;
  /// `what` says of what.
  void finish(const MeshFile& file, const std::string& place, const char* what);
  /// kNone for a number that no item has.
  VertexId find(std::uint64_t number) const;
  std::size_t size() const { return numbers_.size(); }

 private:
  std::vector<std::pair<std::uint64_t, VertexId>> numbers_;  // by number once finished
  std::vector<VertexId> table_;                              // by number - first, if that is about as short
};

}  // namespace podm::verify
