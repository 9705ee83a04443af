// Makes the words of near bricks when a query first needs them, where the voxels stay in the image's file.
//
// Bricks are read in pages of 16^3. To make a page's words, its voxels are read with three more bricks on
// each side. Within two bricks around the page all surface voxels are then known: their neighbors have been
// read. The features of the page's voxels lie there (brick_features.h), so each word is the one that the
// whole image would give.
//
//   Concurrency. A mutex is held while a page is read, so each page is read once. The words of a brick are
//   complete before its entry is stored (release), and a query reads the entry first (acquire). Words that
//   are in use never change.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "isosurface/feature_transform.h"
#include "isosurface/feature_writer.h"

namespace podm {

class UnreadBricks {
 public:
  /// `first_line` is the first unused line of the words. Keeps the references.
  UnreadBricks(const ImageByBricks& image, const BrickGrid& bricks, std::size_t first_line,
               HugeArray<std::uint64_t>& words);

  /// Returns the entry of a brick, whose words have been made.
  Brick read(std::size_t index);
  std::uint64_t bytes_read() const;

 private:
  struct Range;
  class Page;
  Range page_of(std::size_t index) const;
  void read_page(const Range& page);

  const ImageByBricks& image_;
  const BrickGrid& bricks_;
  const Surroundings surroundings_;
  HugeArray<std::uint64_t>& words_;
  const std::size_t first_line_;
  std::atomic<std::size_t> next_line_;
  std::array<std::mutex, 64> mutexes_;  // by a hash of the page
};

}  // namespace podm
