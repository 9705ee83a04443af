// Words that one worker may read while another writes them. Either the writer holds the locks that guard
// them, and the reader only guesses: it locks the vertices that the guess names and then reads again
// (Operation::reserve). Or all workers write the same value (Rules::label_of). Or both values are right for
// the reader (Mesh::facets_passing_r3).
#pragma once

#include <atomic>

namespace podm {

// C++20's std::atomic_ref takes no const word; a load writes nothing.
template <class T>
T load(const T& word, std::memory_order order) {
  return std::atomic_ref<T>(const_cast<T&>(word)).load(order);
}
template <class T>
void store(T& word, T value, std::memory_order order) {
  std::atomic_ref<T>(word).store(value, order);
}

}  // namespace podm
