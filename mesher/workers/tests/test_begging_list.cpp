#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "workers/begging_list.h"

namespace podm::test {
namespace {

// Two nodes of two sockets of three workers.
const WorkerGroups kNested{{0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3}, {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}};

TEST(BeggingList, OneListServesFirstComeFirst) {
  BeggingList list(4, {});
  EXPECT_FALSE(list.may_serve(0));
  for (const WorkerId beggar : {2u, 1u, 3u}) list.add(beggar);
  for (const WorkerId beggar : {2u, 1u, 3u}) {
    EXPECT_TRUE(list.may_serve(0));
    EXPECT_EQ(list.first_for(0), beggar);
    list.remove(beggar);
  }
  EXPECT_EQ(list.first_for(0), kNoWorker);
}

TEST(BeggingList, BeggarsAreSeenOutsideOnceAllOfTheirGroupBeg) {
  BeggingList list(12, kNested);
  list.add(0);
  EXPECT_EQ(list.first_for(1), 0);
  EXPECT_EQ(list.first_for(3), kNoWorker);
  list.add(1);
  EXPECT_FALSE(list.may_serve(4));
  list.add(2);
  EXPECT_EQ(list.first_for(4), 0) << "the socket is idle: the node sees it";
  EXPECT_EQ(list.first_for(8), kNoWorker);
  for (const WorkerId beggar : {3u, 4u, 5u}) list.add(beggar);
  EXPECT_EQ(list.first_for(8), 0) << "the node is idle: the machine sees it";
  list.remove(4);
  EXPECT_EQ(list.first_for(8), kNoWorker);
}

TEST(BeggingList, TheNearestIsServedFirst) {
  BeggingList list(12, kNested);
  for (const WorkerId beggar : {6u, 7u, 8u, 9u, 10u, 11u, 3u, 4u, 5u, 1u}) list.add(beggar);
  std::vector<WorkerId> served;
  for (WorkerId next = list.first_for(0); next != kNoWorker; next = list.first_for(0)) {
    served.push_back(next);
    list.remove(next);
  }
  // Once a socket or node has been served in part, its others are seen there only.
  EXPECT_EQ(served, (std::vector<WorkerId>{1, 3, 6}));
}

TEST(BeggingList, ALastWorkerSeesAllOthersAndTheHintIsRight) {
  std::mt19937 random(4);
  for (const WorkerGroups& groups : {WorkerGroups{}, kNested}) {
    BeggingList list(12, groups);
    std::set<WorkerId> begging;
    for (int step = 0; step < 5000; ++step) {
      const auto worker = static_cast<WorkerId>(random() % 12);
      if (begging.erase(worker) > 0) {
        list.remove(worker);
      } else if (begging.size() < 11) {
        list.add(worker);
        begging.insert(worker);
      }
      for (WorkerId giver = 0; giver < 12; ++giver) {
        if (begging.contains(giver)) continue;
        const WorkerId first = list.first_for(giver);
        EXPECT_EQ(list.may_serve(giver), first != kNoWorker);
        if (first != kNoWorker) {
          EXPECT_TRUE(begging.contains(first));
        }
        if (begging.size() == 11) {
          EXPECT_NE(first, kNoWorker);
        }
      }
    }
  }
}

}  // namespace
}  // namespace podm::test
