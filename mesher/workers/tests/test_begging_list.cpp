#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "two_sockets.h"
#include "workers/begging_list.h"

namespace podm::test {
namespace {

TEST(BeggingList, OneListServesFirstComeFirst) {
  BeggingList list(4, {});
  EXPECT_FALSE(list.may_serve(0));
  for (const WorkerId beggar : {2u, 1u, 3u}) list.add(beggar);
  for (const WorkerId beggar : {2u, 1u, 3u}) {
    EXPECT_TRUE(list.may_serve(0));
    EXPECT_EQ(list.take_first_for(0).worker, beggar);
  }
  EXPECT_EQ(list.take_first_for(0).worker, kNoWorker);
}

TEST(BeggingList, TheLastOfAGroupToBegIsSeenAroundIt) {
  BeggingList list(12, kNested);
  for (const WorkerId beggar : {0u, 1u}) list.add(beggar);
  EXPECT_FALSE(list.may_serve(4)) << "a worker of the socket is left";
  list.add(2);
  EXPECT_TRUE(list.may_serve(4)) << "the socket is idle: the node sees one";
  EXPECT_FALSE(list.may_serve(8));
  EXPECT_EQ(list.take_first_for(4).worker, 2);
  EXPECT_FALSE(list.may_serve(4)) << "the others wait for it";
  for (const WorkerId beggar : {2u, 3u, 4u, 5u}) list.add(beggar);
  EXPECT_EQ(list.take_first_for(8).worker, 5) << "the node is idle: the machine sees one";
}

TEST(BeggingList, TheNearestIsServedFirst) {
  BeggingList list(12, kNested);
  for (const WorkerId beggar : {6u, 7u, 8u, 9u, 10u, 11u, 3u, 4u, 5u, 1u}) list.add(beggar);
  std::vector<WorkerId> served;
  for (auto next = list.take_first_for(0); next.worker != kNoWorker; next = list.take_first_for(0))
    served.push_back(next.worker);
  EXPECT_EQ(served, (std::vector<WorkerId>{1, 5, 11})) << "of socket, node, machine";
}

TEST(BeggingList, AClosedOneNamesAllThatWereOnItAndTakesNoWorker) {
  for (const WorkerGroups& groups : {WorkerGroups{}, kNested}) {
    BeggingList list(12, groups);
    const std::set<WorkerId> beggars{2, 3, 4, 5, 6, 8, 11};
    for (const WorkerId beggar : beggars) EXPECT_TRUE(list.add(beggar));
    const std::vector<WorkerId> named = list.close();
    EXPECT_EQ(named.size(), beggars.size());
    EXPECT_EQ(std::set<WorkerId>(named.begin(), named.end()), beggars);
    for (WorkerId worker = 0; worker < 12; ++worker) EXPECT_FALSE(list.add(worker));
    EXPECT_EQ(list.take_first_for(0).worker, kNoWorker);
  }
}

TEST(BeggingList, ALastWorkerSeesOneAndTheHintIsRight) {
  std::mt19937 random(4);
  for (const WorkerGroups& groups : {WorkerGroups{}, kNested}) {
    BeggingList list(12, groups);
    std::set<WorkerId> begging;
    const auto busy = [&] {
      WorkerId worker;
      do worker = static_cast<WorkerId>(random() % 12);
      while (begging.contains(worker));
      return worker;
    };
    for (int step = 0; step < 20000; ++step) {
      if (begging.size() < 11 && random() % 2 == 0) {
        const WorkerId beggar = busy();
        list.add(beggar);
        begging.insert(beggar);
      } else if (!begging.empty() && random() % 8 == 0) {
        const WorkerId removed = *begging.begin();
        list.remove(removed);
        begging.erase(removed);
      } else {
        const WorkerId giver = busy();
        const bool may_serve = list.may_serve(giver);
        const auto [first, level] = list.take_first_for(giver);
        EXPECT_EQ(may_serve, first != kNoWorker);
        EXPECT_TRUE(first == kNoWorker || begging.contains(first));
        EXPECT_TRUE(begging.size() < 11 || first != kNoWorker) << "step " << step;
        if (first != kNoWorker && random() % 4 == 0) {
          list.put_back({first, level});
          EXPECT_EQ(list.take_first_for(giver).worker, first);
        }
        begging.erase(first);
      }
    }
  }
}

}  // namespace
}  // namespace podm::test
