#include "isosurface/surface_tree.h"

#include <algorithm>

namespace podm {

SurfaceTree::SurfaceTree(const BrickGrid& bricks, std::span<const std::uint64_t> masks,
                         const std::array<double, 3>& spacing)
    : spacing_(spacing) {
  BrickGrid below = bricks;
  const std::uint64_t* children = masks.data();
  do {
    Level level{BrickGrid(below.size()), {}};
    level.masks.resize(level.nodes.count());
    std::size_t child = 0;
    for (int k = 0; k < below.size()[2]; ++k)
      for (int j = 0; j < below.size()[1]; ++j)
        for (int i = 0; i < below.size()[0]; ++i, ++child)
          if (children[child] != 0)
            level.masks[level.nodes.index_of_voxel({i, j, k})] |= std::uint64_t{1}
                                                                  << place_in_brick({i, j, k});
    below = level.nodes;
    levels_.push_back(std::move(level));
    children = levels_.back().masks.data();
  } while (below.count() > 1);
}

}  // namespace podm
