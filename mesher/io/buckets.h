// Groups items into buckets, on all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "runtime/huge_array.h"
#include "runtime/parallel_for.h"

namespace podm {

/// Items grouped by bucket. Within a bucket they keep their order.
template <class Item>
class Buckets {
 public:
  /// Puts item i < num_items into bucket bucket_of(i, end) < num_buckets. bucket_of(i, end) is called once
  /// per item, before item_at(i), in ascending order by the thread that handles the items up to `end`.
  /// `bucket_of_item` must return the same bucket.
  template <class BucketOf, class ItemAt, class BucketOfItem>
  Buckets(std::size_t num_items, std::size_t num_buckets, std::size_t threads, const BucketOf& bucket_of,
          const ItemAt& item_at, const BucketOfItem& bucket_of_item)
      : begin_(num_buckets + 1), items_(num_items + 1) {
    // Bounds the number of chunks so that their counts take at most two bytes per item.
    const std::size_t most_chunks = std::max<std::size_t>(1, num_items / (4 * num_buckets));
    const std::size_t num_chunks = threads > 1 ? std::min(2 * threads, most_chunks) : 1;
    const std::size_t length = num_items / num_chunks + 1;
    // Number of items per bucket in each chunk; later the position of its next item.
    std::vector<std::vector<std::size_t>> places(num_chunks, std::vector<std::size_t>(num_buckets));
    parallel_for_ranges(num_items, length, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
      std::vector<std::size_t>& counts = places[begin / length];
      for (std::size_t i = begin; i < end; ++i) ++counts[bucket_of(i, end)];
    });
    sum_up(places);
    parallel_for_ranges(num_items, length, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
      std::vector<std::size_t>& next = places[begin / length];
      for (std::size_t i = begin; i < end; ++i) {
        const Item item = item_at(i);
        items_[next[bucket_of_item(item)]++] = item;
      }
    });
  }

  std::size_t size() const { return begin_.size() - 1; }
  /// Returns the size of the largest bucket.
  std::size_t largest() const {
    std::size_t most = 0;
    for (std::size_t bucket = 0; bucket < size(); ++bucket)
      most = std::max(most, begin_[bucket + 1] - begin_[bucket]);
    return most;
  }
  /// Returns the position of the bucket's first item among all items.
  std::size_t begin(std::size_t bucket) const { return begin_[bucket]; }
  std::span<Item> operator[](std::size_t bucket) {
    return {&items_[begin_[bucket]], begin_[bucket + 1] - begin_[bucket]};
  }

 private:
  void sum_up(std::vector<std::vector<std::size_t>>& places) {
    std::size_t sum = 0;
    for (std::size_t bucket = 0; bucket < size(); ++bucket) {
      begin_[bucket] = sum;
      for (std::vector<std::size_t>& chunk : places) {
        const std::size_t count = chunk[bucket];
        chunk[bucket] = sum;
        sum += count;
      }
    }
    begin_.back() = sum;
  }

  std::vector<std::size_t> begin_;
  HugeArray<Item> items_;
};

}  // namespace podm
