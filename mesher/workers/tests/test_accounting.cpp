// The rules of virtual time between attempts: an accounted operation does what the plain one does, and
// charges its worker once. The costs in these tests are powers of two, so that a sum shows the costs in it.
#include "workers/accounting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace podm::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Charge {
  WorkerId self;
  double seconds;
  const void* section = nullptr;  // none: other workers may do the same at the same time

  bool operator==(const Charge&) const = default;
};

// A time that lists its charges, and the calls of the objects below between them.
struct Ledger {
  void spend(WorkerId self, double seconds) { spend_in(nullptr, self, seconds); }
  void spend_in(const void* section, WorkerId self, double seconds) {
    charges.push_back({self, seconds, section});
    order += "charge ";
  }
  static TimeCosts costs() {
    TimeCosts costs;
    costs.begging = 1024;
    costs.entry_given = 1;
    costs.entry_to_leaf = 2;
    costs.cell_moved = 4;
    costs.cell_judged = 8;
    costs.leaf_shared_out = 16;
    costs.leaf_handed_out = 32;
    return costs;
  }

  std::vector<Charge> charges;
  std::string order;
};

// Lists many cells, and shares three of them.
struct Giver {
  std::size_t num_listed() const { return listed; }
  Coordination::Entries share(std::size_t) {
    listed -= 3;
    return Coordination::Entries(3);
  }
  static WorkerId conflicting_worker() { return kNoWorker; }

  std::size_t listed = 1000;
};

TEST(AccountedGroup, ChargesForBeggingAndForGifts) {
  Ledger time;
  Coordination plain({.num_workers = 2}, [](WorkerId) {});
  const AccountedGroup group(plain, time);
  Giver giver;
  EXPECT_EQ(group.beg(1), Coordination::Begging::kListed);
  EXPECT_EQ(group.after(Outcome::kCommitted, 0, giver).kind, Coordination::Answer::kTryOn);
  EXPECT_EQ(group.take_gift(1).size(), 3u);
  EXPECT_THAT(time.charges, ElementsAre(Charge{1, 1024, &plain}, Charge{0, 1024 + 3, &plain}, Charge{1, 3}));
}

TEST(AccountedGroup, ChargesNothingAfterAnAttemptWithoutAGift) {
  Ledger time;
  Coordination plain({.num_workers = 2}, [](WorkerId) {});
  Giver giver;
  AccountedGroup(plain, time).after(Outcome::kCommitted, 0, giver);
  EXPECT_THAT(time.charges, IsEmpty());
}

TEST(AccountedGroup, ChargesTheSenderForCellsSentHome) {
  Ledger time;
  Coordination plain({.num_workers = 2, .workers_per_home = 1}, [](WorkerId) {});
  const AccountedGroup group(plain, time);
  group.send(0, 1, Coordination::Entries(5));
  EXPECT_EQ(group.beg(1), Coordination::Begging::kHasGift);
  EXPECT_EQ(group.take_gift(1).size(), 5u);
  EXPECT_THAT(time.charges, ElementsAre(Charge{0, 1024 + 5}, Charge{1, 1024, &plain}, Charge{1, 5}));
}

// Stand-ins for the refinement queue, the cells of leaves, a computing node and a relocation. Each notes its
// calls in the order of the ledger, and returns the same number of cells as its number.
struct Queue {
  template <class Wait>
  int wait_and_pop(unsigned node, const Wait&, bool) {
    time.order += "pop ";
    return static_cast<int>(node);
  }
  void finish(int) { time.order += "finish "; }

  Ledger& time;
};
using Cells = std::vector<int>;
struct LeafCells {
  static unsigned num_leaves() { return 6; }
  std::size_t distribute(std::size_t slice) { return note("distribute ", slice); }
  void share_out(Queue&, bool) { note("share_out ", 0); }
  std::size_t rename(int, std::size_t part, std::size_t num_parts) {
    return note("rename ", part + num_parts);
  }
  Cells take(std::size_t leaf) { return Cells(note("take ", leaf)); }
  void add(const Cells&, Queue&, bool) { note("add ", 0); }

  std::size_t note(const char* call, std::size_t number) {
    time.order += call;
    return number;
  }
  Ledger& time;
};
struct Node {
  struct Master {
    static WorkerId id() { return 4; }
  };
  static Master master() { return {}; }
  std::size_t num_foreign() const { return foreign; }
  int end(LeafCells& cells, Queue& queue, bool) {
    cells.add({}, queue, false);
    cells.add({}, queue, false);
    foreign = 0;
    return 77;
  }

  std::size_t foreign = 9;
};
struct Moves {
  static std::size_t num_workers() { return 4; }
  static std::uint32_t cell_bound() { return 12; }
  void look(WorkerId, int) { time.order += "look "; }
  void rename(WorkerId, int) { time.order += "rename "; }
  std::size_t move(WorkerId, int) {
    time.order += "move ";
    return 10;
  }

  Ledger& time;
};

class AccountedLeaves : public testing::Test {
 protected:
  Ledger time_;
  Queue plain_queue_{time_};
  LeafCells plain_cells_{time_};
  AccountedQueue<Queue, Ledger> queue_{plain_queue_, time_};
  AccountedLeafCells<LeafCells, Ledger> cells_{plain_cells_, time_};
};

TEST_F(AccountedLeaves, AreHandedOutOneAfterTheOther) {
  EXPECT_EQ(queue_.wait_and_pop(
                3, 5u, [] {}, false),
            5);
  queue_.finish(3, 5);
  EXPECT_EQ(time_.order, "charge pop charge finish ");
  EXPECT_THAT(time_.charges, ElementsAre(Charge{3, 32, &plain_queue_}, Charge{3, 32, &plain_queue_}));
}

TEST_F(AccountedLeaves, ChargeForEachCellListedOrTaken) {
  cells_.distribute(1, 7);
  cells_.add(2, Cells(8), queue_, false);
  EXPECT_EQ(cells_.take(3, 9).size(), 9u);
  cells_.rename(1, 0, 4);
  EXPECT_EQ(time_.order, "distribute charge charge add take charge rename charge ");
  EXPECT_THAT(time_.charges, ElementsAre(Charge{1, 2 * 7}, Charge{2, 2 * 8}, Charge{3, 9}, Charge{1, 1 + 4}));
}

TEST_F(AccountedLeaves, AreSharedOutByOneWorker) {
  cells_.share_out(2, queue_, false);
  EXPECT_EQ(time_.order, "share_out charge ");
  EXPECT_THAT(time_.charges, ElementsAre(Charge{2, 16 * 6}));
}

TEST_F(AccountedLeaves, ChargeTheMasterOnceForAllCellsThatItsNodeHandsOver) {
  Node node;
  EXPECT_EQ(cells_.end(node, queue_, false), 77);
  EXPECT_EQ(time_.order, "add add charge ");
  EXPECT_THAT(time_.charges, ElementsAre(Charge{4, 2 * 9}));
}

TEST(AccountedRelocation, ChargesForTheShareLookedAtAndForCellsMoved) {
  Ledger time;
  Moves plain{time};
  const AccountedRelocation moves(plain, time);
  int pool = 0;
  moves.look(1, 0);
  moves.rename(1, pool);
  moves.move(1, pool);
  EXPECT_EQ(time.order, "look charge rename move charge ");
  EXPECT_THAT(time.charges, ElementsAre(Charge{1, 2 * 12 / 4.0}, Charge{1, 4 * 10}));
}

TEST(JudgeCells, ChargesForEachCellJudged) {
  Ledger time;
  judge_cells(
      3, [](WorkerId self) { return 2 * self; }, time);
  EXPECT_THAT(time.charges, ElementsAre(Charge{3, 8 * 6}));
}

TEST(PhaseWork, CostsAsMuchAsItsPieces) {
  TimeCosts costs;
  costs.thread_started = 4;
  costs.cube_made = 8;
  EXPECT_EQ(starting_threads(1).seconds(costs), 0) << "the calling thread is there";
  EXPECT_EQ(starting_threads(4).seconds(costs), 12);
  EXPECT_EQ(making_cubes(3).seconds(costs), 24);
}

}  // namespace
}  // namespace podm::test
