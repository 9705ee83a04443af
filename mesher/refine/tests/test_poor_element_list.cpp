// Compares the list with a plain vector of its entries, and measures the memory that it gives back.
#include "refine/poor_element_list.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <random>

namespace podm::test {
namespace {

using Entry = PoorElementList::Entry;

bool is_same(const Entry& a, const Entry& b) { return a.cell == b.cell && a.stamp == b.stamp; }

class PoorElements : public testing::Test {
 protected:
  static constexpr std::size_t kCells = 1 << 20;
  void SetUp() override { mesh_.cell_ids().take(kCells / 2, 0); }

  CellId some_cell() { return static_cast<CellId>(random_() % (kCells / 2)); }
  void replace(CellId c) { mesh_.renew(c, {kNoVertex, kNoVertex, kNoVertex, kNoVertex}); }
  bool is_live(const Entry& e) const { return mesh_.stamp(e.cell) == e.stamp; }
  void push() {
    const CellId c = some_cell();
    reference_.push_back({c, mesh_.stamp(c)});
    list_.push(c, mesh_.stamp(c));
  }
  void expect_same_order() {
    ASSERT_EQ(list_.size(), reference_.size());
    for (std::size_t turns = 0; turns < reference_.size(); turns += 1 + reference_.size() / 100)
      ASSERT_EQ(list_.upcoming(turns).cell, reference_[reference_.size() - 1 - turns].cell);
    if (!reference_.empty()) {
      ASSERT_EQ(list_.upcoming(reference_.size() + 5).cell, reference_.front().cell);
    }
  }
  // Does to the reference what take_oldest() is to do to the list.
  std::vector<Entry> take_oldest(std::size_t max) {
    std::vector<Entry> taken;
    std::size_t scanned = 0;
    for (; scanned < reference_.size() / 2 && taken.size() < max; ++scanned)
      if (is_live(reference_[scanned])) taken.push_back(reference_[scanned]);
    reference_.erase(reference_.begin(), reference_.begin() + static_cast<std::ptrdiff_t>(scanned));
    return taken;
  }

  Mesh mesh_{{{0, 0, 0}, {1, 1, 1}}, kCells};
  PoorElementList list_{kCells};
  std::vector<Entry> reference_;
  std::mt19937_64 random_{5};
};

TEST_F(PoorElements, ComeLastInFirstOutWhateverIsDroppedOrTaken) {
  for (int round = 0; round < 60; ++round) {
    for (auto pushes = random_() % 40000; pushes > 0; --pushes) push();
    for (int died = 0; died < 20000; ++died) replace(some_cell());
    for (auto pops = std::min<std::size_t>(reference_.size(), random_() % 35000); pops > 0; --pops) {
      ASSERT_TRUE(is_same(list_.pop(), reference_.back()));
      reference_.pop_back();
    }
    if (list_.is_due_for_cleaning()) {
      list_.drop_stale(mesh_);
      std::erase_if(reference_, [&](const Entry& e) { return !is_live(e); });
    }
    if (round % 7 == 3) {
      const auto taken = list_.take_oldest(5000, mesh_), expected = take_oldest(5000);
      ASSERT_TRUE(std::equal(taken.begin(), taken.end(), expected.begin(), expected.end(), is_same));
    }
    expect_same_order();
  }
  for (; !reference_.empty(); reference_.pop_back()) ASSERT_TRUE(is_same(list_.pop(), reference_.back()));
  EXPECT_TRUE(list_.is_empty());
}

TEST_F(PoorElements, AreCleanedSoOftenThatAtMostTwoThirdsAreStale) {
  std::size_t num_live = 0;
  for (int i = 0; i < 4 << 20; ++i) {
    replace(some_cell());
    push();
    if (!list_.is_due_for_cleaning()) continue;
    list_.drop_stale(mesh_);
    EXPECT_LE(list_.size(), kCells / 2);
  }
  EXPECT_LE(list_.size(), PoorElementList::kGrowth * kCells / 2);
  while (!list_.is_empty()) num_live += is_live(list_.pop());
  EXPECT_GT(num_live, kCells / 8);
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::int64_t page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt;
}

// Other code of the process may cause faults in some of the rounds.
TEST_F(PoorElements, KeepTheMemoryIntoWhichTheyGrowAgain) {
  PoorElementList list(std::size_t{1} << 22);
  const auto stale = static_cast<std::uint16_t>(mesh_.stamp(0) + 1);
  const auto grow_to_cleaning = [&] {
    while (!list.is_due_for_cleaning()) list.push(0, stale);
  };
  grow_to_cleaning();
  const auto pages = static_cast<std::int64_t>(sizeof(Entry) * list.size()) / sysconf(_SC_PAGESIZE);
  ASSERT_GE(pages, 8);
  std::int64_t least = pages;
  for (int round = 0; round < 20; ++round) {
    const std::int64_t faults = page_faults();
    list.drop_stale(mesh_);
    ASSERT_TRUE(list.is_empty());
    grow_to_cleaning();
    least = std::min(least, page_faults() - faults);
  }
  EXPECT_LT(least, pages / 4);
}

// The list moves on through its chunks: a worker adds at one end while others take from the other one.
TEST_F(PoorElements, UseTheMemoryOfTakenOnesAgain) {
  constexpr std::size_t kPushed = 40000;
  PoorElementList list(std::size_t{1} << 22);
  const auto pages = static_cast<std::int64_t>(sizeof(Entry) * kPushed) / sysconf(_SC_PAGESIZE);
  std::int64_t least = pages;
  for (int round = 0; round < 40; ++round) {
    const std::int64_t faults = page_faults();
    for (std::size_t i = 0; i < kPushed; ++i) list.push(0, mesh_.stamp(0));
    while (list.size() > kPushed / 4) list.take_oldest(64, mesh_);
    least = std::min(least, page_faults() - faults);
  }
  EXPECT_LT(least, pages / 4);
}

TEST_F(PoorElements, GiveTheirMemoryBackAsTheyBecomeFewer) {
  constexpr std::size_t kBytes = 64 << 20, kEntries = kBytes / sizeof(Entry);
  for (std::size_t i = 0; i < kEntries; ++i) list_.push(0, 0);
  const std::size_t long_list = resident_bytes();
  for (std::size_t i = 0; i < kEntries / 2; ++i) list_.pop();
  const std::size_t half_list = resident_bytes();
  replace(0);
  EXPECT_TRUE(list_.take_oldest(kEntries, mesh_).empty()) << "all are stale";
  const std::size_t quarter_list = resident_bytes();
  // A sanitizer gives shadow memory back, too.
  EXPECT_GE(static_cast<double>(long_list - half_list), kBytes / 2. - kBytes / 32.);
  EXPECT_GE(static_cast<double>(half_list - quarter_list), kBytes / 4. - kBytes / 32.);
  list_.drop_stale(mesh_);
  EXPECT_GE(static_cast<double>(quarter_list - resident_bytes()), kBytes / 4. - kBytes / 32.);
}

}  // namespace
}  // namespace podm::test
