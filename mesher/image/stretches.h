// Visits voxels in short stretches. In a label image nearly all stretches have a single value.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace podm {

/// Calls use(from, to, is_uniform) for consecutive stretches of [begin, end). `is_uniform` is true if all
/// voxels of the stretch, of `width` bytes each, are equal bit by bit.
template <class Use>
void for_each_stretch(const void* voxels, std::size_t width, std::size_t begin, std::size_t end,
                      const Use& use) {
  constexpr std::size_t kLongest = 64;
  for (std::size_t to = begin; begin < end; begin = to) {
    to = std::min(begin + kLongest, end);
    const char* const first = static_cast<const char*>(voxels) + begin * width;
    use(begin, to, std::memcmp(first, first + width, (to - begin - 1) * width) == 0);
  }
}

}  // namespace podm
