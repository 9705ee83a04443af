#include "readers/point_directory.h"

#include <algorithm>

#include "readers/vtu_grid.h"

namespace podm::verify {

std::vector<Holder> PointDirectory::enter(const std::vector<PointOfPiece>& points) {
  auto lists = lists_for<PointOfPiece>(ranks_);
  for (const PointOfPiece& point : points) lists[rank_for(point.id)].push_back(point);
  lists = exchange(ranks_, std::move(lists));
  std::size_t num_points = 0;
  for (const std::vector<PointOfPiece>& list : lists) num_points += list.size();
  entries_.reserve(num_points);
  for (std::uint32_t rank = 0; rank < lists.size(); ++rank) {
    for (const PointOfPiece& point : lists[rank]) entries_.push_back({point, rank});
    std::vector<PointOfPiece>().swap(lists[rank]);
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.point.id < b.point.id; });
  auto holders = lists_for<Holder>(ranks_);
  std::size_t kept = 0;
  for (std::size_t first = 0, end = 0; first < entries_.size(); first = end) {
    const Entry entry = entries_[first];
    for (end = first; end < entries_.size() && entries_[end].point.id == entry.point.id; ++end)
      if (!is_same_point(entries_[end].point.point, entry.point.point))
        differences_.push_back({entry.point, entries_[end].point});
    for (std::size_t a = first; a < end; ++a)
      for (std::size_t b = first; b < end; ++b)
        if (a != b) holders[entries_[a].rank].push_back({entry.point.id, entries_[b].rank});
    entries_[kept++] = entry;
  }
  entries_.resize(kept);
  std::vector<Holder> all = exchange_joined(ranks_, std::move(holders));
  std::stable_sort(all.begin(), all.end());
  return all;
}

GlobalId PointDirectory::num_ids() const { return sum_over(ranks_, entries_.size()); }

GlobalId PointDirectory::first_gap() const {
  auto gap = static_cast<GlobalId>(ranks_.rank());
  for (const Entry& entry : entries_) {
    if (entry.point.id != gap) break;
    gap += static_cast<GlobalId>(ranks_.size());
  }
  const std::vector<GlobalId> gaps = gather(ranks_, gap);
  return *std::min_element(gaps.begin(), gaps.end());
}

const PointDirectory::Entry* PointDirectory::find(const PointOfPiece& point) const {
  const auto found = std::lower_bound(entries_.begin(), entries_.end(), point.id,
                                      [](const Entry& entry, GlobalId id) { return entry.point.id < id; });
  const bool is_there = found != entries_.end() && found->point.id == point.id &&
                        is_same_point(found->point.point, point.point);
  return is_there ? &*found : nullptr;
}

std::vector<std::uint32_t> PointDirectory::find_owners(const std::vector<PointOfPiece>& points) const {
  auto asked = lists_for<PointOfPiece>(ranks_);
  for (const PointOfPiece& point : points) asked[rank_for(point.id)].push_back(point);
  asked = exchange(ranks_, std::move(asked));
  auto answers = lists_for<std::uint32_t>(ranks_);
  for (std::size_t rank = 0; rank < asked.size(); ++rank)
    for (const PointOfPiece& point : asked[rank]) {
      const Entry* entry = find(point);
      answers[rank].push_back(entry == nullptr ? kNoRank : entry->rank);
    }
  answers = exchange(ranks_, std::move(answers));
  std::vector<std::size_t> next(answers.size(), 0);
  std::vector<std::uint32_t> owners;
  for (const PointOfPiece& point : points) {
    const std::size_t rank = rank_for(point.id);
    owners.push_back(answers[rank][next[rank]++]);
  }
  return owners;
}

}  // namespace podm::verify
