// Orders of processors by their properties, pin plans and their refusals, and a thread that is actually
// bound.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <thread>
#include <tuple>

#include "runtime/placement.h"
#include "runtime/tests/machines.h"
#include "tests/fault_of.h"

namespace podm::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Returns every worker's place; there are `more` workers than processors.
std::vector<Place> places_on(const Topology& machine, const char* plan, int more = 0) {
  const int num_workers = static_cast<int>(machine.processors().size()) + more;
  return place_workers(machine, PinPlan::parse(plan), num_workers, more > 0);
}

std::vector<Processor> processors_of(const Topology& machine, const std::vector<Place>& places) {
  std::map<int, Processor> by_os_index;
  for (const Processor& processor : machine.processors()) by_os_index[processor.os_index] = processor;
  std::vector<Processor> result;
  for (const Place& place : places) {
    result.push_back(by_os_index.at(place.processor.value()));
    EXPECT_EQ(place.node, result.back().node);
    EXPECT_EQ(place.socket, result.back().socket);
  }
  return result;
}

// The machines have one or several nodes, sockets, cores and hardware threads.
class Order : public testing::TestWithParam<const char*> {
 protected:
  const Topology machine_ = Topology::synthetic(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Machines, Order,
                         testing::Values("pack:1 core:8 pu:1", "pack:2 numa:2 core:4 pu:2", "core:3 pu:4",
                                         "numa:16 pack:2 core:8 pu:1", "pu:1"));

TEST_P(Order, UsesEveryProcessorOnceBeforeAnyTwice) {
  for (const char* plan : {"compact", "scatter"}) {
    const auto order = processors_of(machine_, places_on(machine_, plan, 5));
    const std::size_t num_processors = machine_.processors().size();
    std::set<int> used;
    for (std::size_t worker = 0; worker < num_processors; ++worker)
      EXPECT_TRUE(used.insert(order[worker].os_index).second) << plan << ' ' << worker;
    for (std::size_t worker = num_processors; worker < order.size(); ++worker)
      EXPECT_EQ(order[worker].os_index, order[worker - num_processors].os_index) << plan;
  }
}

TEST_P(Order, CompactFillsNodesInTurnAndCoresBeforeSiblings) {
  const auto order = processors_of(machine_, places_on(machine_, "compact"));
  for (std::size_t worker = 1; worker < order.size(); ++worker) {
    const Processor &before = order[worker - 1], &next = order[worker];
    EXPECT_LE(std::tie(before.node, before.thread, before.core), std::tie(next.node, next.thread, next.core));
  }
}

TEST_P(Order, ScatterKeepsNodesBalancedAndSiblingsLast) {
  std::vector<int> workers_on(machine_.num_nodes());
  int thread = 0;
  for (const Processor& processor : processors_of(machine_, places_on(machine_, "scatter"))) {
    ++workers_on[processor.node];
    const auto [least, most] = std::minmax_element(workers_on.begin(), workers_on.end());
    EXPECT_LE(*most - *least, 1);
    EXPECT_LE(thread, processor.thread);
    thread = processor.thread;
  }
}

TEST_P(Order, NoneSpreadsNodesAndBindsNoThread) {
  const auto bound = places_on(machine_, "scatter"), free = places_on(machine_, "none");
  ASSERT_EQ(bound.size(), free.size());
  for (std::size_t worker = 0; worker < free.size(); ++worker) {
    EXPECT_FALSE(free[worker].processor);
    EXPECT_EQ(free[worker].node, bound[worker].node);
    EXPECT_EQ(free[worker].socket, bound[worker].socket);
  }
}

TEST_P(Order, OfFewerWorkersIsThatOfAllCutShort) {
  for (const char* plan : {"compact", "scatter", "none"}) {
    const auto all = places_on(machine_, plan);
    const auto one = place_workers(machine_, PinPlan::parse(plan), 1, false);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_EQ(one[0].processor, all[0].processor);
  }
}

TEST(PinPlan, ListsProcessorsInTheirOrder) {
  EXPECT_THAT(PinPlan::parse("0,2,4-7").os_indices, ElementsAre(0, 2, 4, 5, 6, 7));
  EXPECT_THAT(PinPlan::parse("5,3-3,0").os_indices, ElementsAre(5, 3, 0));
  const auto order =
      processors_of(two_sockets(), place_workers(two_sockets(), PinPlan::parse("9,1"), 2, false));
  EXPECT_EQ(order[0].os_index, 9);
  EXPECT_EQ(order[1].os_index, 1);
}

TEST(PinPlan, NamesTheBadPieceAndWhatIsAllowed) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "\"\""},           {"dense", "\"dense\""},
      {"0,,1", "\"\""},       {"0,x", "\"x\""},
      {"3,1-", "\"1-\""},     {"-1", "\"-1\""},
      {"0,7-4", "\"7-4\""},   {"1,0-2", "\"0-2\""},
      {"1-2-3", "\"1-2-3\""}, {"0, 1", "\" 1\""},
      {"0,1,", "\"\""},       {"Compact", "\"Compact\""},
      {"8192", "\"8192\""},   {"0-99999999999", "\"0-99999999999\""}};
  for (const auto& [plan, piece] : cases)
    EXPECT_THAT(
        fault_of<PlacementError>([&plan = plan] { PinPlan::parse(plan); }),
        AllOf(HasSubstr(std::string("\"") + plan + "\": " + piece), HasSubstr("compact, scatter, none")));
}

TEST(Placement, RefusesMoreWorkersThanProcessors) {
  for (const char* plan : {"compact", "scatter", "none"})
    EXPECT_THAT(fault_of<PlacementError>([&] { place_workers(one_node(), PinPlan::parse(plan), 9, false); }),
                AllOf(HasSubstr("9 workers"), HasSubstr("8 usable processors"), HasSubstr("oversubscribe")));
  EXPECT_THAT(fault_of<PlacementError>([] { place_workers(one_node(), PinPlan::parse("1,2"), 3, false); }),
              AllOf(HasSubstr("3 workers"), HasSubstr("2 processors"), HasSubstr("oversubscribe")));
}

TEST(Placement, RefusesListedProcessorsThatAreNotThere) {
  EXPECT_THAT(fault_of<PlacementError>([] { place_workers(one_node(), PinPlan::parse("0,8"), 1, false); }),
              AllOf(HasSubstr("processor 8"), HasSubstr("8 usable processors")));
}

TEST(Placement, ListedProcessorsAreSharedInTurn) {
  const auto places = place_workers(one_node(), PinPlan::parse("6,2"), 5, true);
  std::vector<int> os_indices;
  for (const Place& place : places) os_indices.push_back(place.processor.value());
  EXPECT_THAT(os_indices, ElementsAre(6, 2, 6, 2, 6));
}

TEST(Pinning, BindsThisThreadToEachProcessorInTurn) {
  const Topology machine = Topology::of_this_machine();
  for (const Processor& processor : machine.processors())
    std::jthread([&] {
      pin_this_thread(processor.os_index);
      const ThreadProcessor achieved = processor_of_this_thread();
      EXPECT_EQ(achieved.bound_to, processor.os_index);
      EXPECT_EQ(achieved.running_on, processor.os_index);
    }).join();
}

TEST(Pinning, OfOneThreadLeavesOthersFree) {
  const ThreadProcessor before = processor_of_this_thread();
  const int os_index = Topology::of_this_machine().processors().front().os_index;
  std::jthread([&] { pin_this_thread(os_index); }).join();
  EXPECT_EQ(processor_of_this_thread().bound_to, before.bound_to);
}

TEST(Pinning, ScopedGivesBackWhatTheThreadHad) {
  const ThreadProcessor before = processor_of_this_thread();
  {
    const int os_index = Topology::of_this_machine().processors().back().os_index;
    const ScopedBinding binding(os_index);
    EXPECT_EQ(processor_of_this_thread().bound_to, os_index);
    const ScopedBinding none(std::nullopt);
    EXPECT_EQ(processor_of_this_thread().bound_to, os_index);
  }
  EXPECT_EQ(processor_of_this_thread().bound_to, before.bound_to);
}

TEST(Pinning, RefusesProcessorsThatAreNotThere) {
  for (const int os_index : {-1, 8191, 8192})
    EXPECT_THAT(fault_of<PlacementError>([&] { pin_this_thread(os_index); }),
                HasSubstr("processor " + std::to_string(os_index)));
}

}  // namespace
}  // namespace podm::test
