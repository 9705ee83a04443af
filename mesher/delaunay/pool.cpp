#include "delaunay/pool.h"

#include <algorithm>

namespace podm {

namespace {

// Makes room for `count` more elements. Doubles the capacity: many small calls therefore cost little.
template <class T>
void reserve_more(std::vector<T>& vector, std::size_t count) {
  const std::size_t needed = vector.size() + count;
  if (vector.capacity() < needed) vector.reserve(std::max(2 * vector.capacity(), needed));
}

}  // namespace

void FreeIds::reserve(std::size_t wanted, std::size_t released) {
  reserve_more(free_, std::max<std::size_t>(released, wanted) + 2 * block_);
  if (foreign_.size() >= block_) {
    ++num_locks_;
    arena_.give_back(foreign_);
  }
  reserve_more(foreign_, released);
  while (free_.size() + (end_ - next_) < wanted) {
    ++num_locks_;
    if (arena_.take_returned(block_, node_, free_)) continue;
    for (; next_ != end_; ++next_) free_.push_back(next_);
    ++num_locks_;
    next_ = arena_.take(block_, node_);
    num_new_ += block_;
    end_ = next_ + block_;
  }
}

std::uint32_t FreeIds::take() {
  if (free_.empty()) return next_++;
  const std::uint32_t id = free_.back();
  free_.pop_back();
  return id;
}

void Pool::reserve(const std::vector<CellId>& dying, std::size_t created, std::size_t removed) {
  const auto is_own = [this](CellId c) { return cells_.is_own(c); };
  const auto reused = static_cast<std::size_t>(std::count_if(dying.begin(), dying.end(), is_own));
  cells_.reserve(created > reused ? created - reused : 0, dying.size());
  vertices_.reserve(1, removed);
}

void Pool::replace(const std::vector<CellId>& dying, std::size_t count, std::vector<CellId>& created) {
  created.resize(count);
  auto next = created.begin();
  for (const CellId c : dying) {
    if (next != created.end() && cells_.is_own(c)) {
      *next++ = c;
      continue;
    }
    mesh_.renew(c, {kNoVertex, kNoVertex, kNoVertex, kNoVertex});
    cells_.release(c);
  }
  std::generate(next, created.end(), [&] { return cells_.take(); });
}

void Pool::release_vertex(VertexId v) {
  mesh_.vertex(v).kind = VertexKind::kUnused;
  vertices_.release(v);
}

}  // namespace podm
