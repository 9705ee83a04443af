// The team that is chosen where options leave it open, and options that are refused.
#include "algorithms/team_size.h"

#include <gtest/gtest.h>

#include "podm/errors.h"

namespace podm::test {
namespace {

TeamSize size_of(Algorithm algorithm, const TeamOptions& team, const std::vector<int>& nodes_of_workers,
                 int crossover = 0) {
  std::vector<Place> places;
  for (const int node : nodes_of_workers) places.push_back({.processor = {}, .node = node});
  EXPECT_EQ(places.size(), static_cast<std::size_t>(num_workers(team)));
  MeshingOptions options;
  options.algorithm = algorithm;
  options.crossover = crossover;
  options.team = team;
  return team_size(options, places);
}

TEST(TeamSize, OneWorkerRefinesUnlessMoreAreAskedFor) {
  EXPECT_EQ(num_workers({}), 1);
  EXPECT_EQ(num_workers({.threads = 6, .nodes = 3}), 6);
  EXPECT_EQ(num_workers({.nodes = 3}), 3);
  EXPECT_EQ(num_workers({.cores_per_node = 2}), 2);
  EXPECT_EQ(num_workers({.nodes = 3, .cores_per_node = 2}), 6);
}

TEST(TeamSize, OtherPhasesHaveTheThreadsThatWereAskedForUnlessTimeIsVirtual) {
  EXPECT_EQ(loop_threads({}), 0);
  EXPECT_EQ(loop_threads({.threads = 3}), 3);
  EXPECT_EQ(loop_threads({.threads = 3, .executor = Executor::kVirtual}), 0);
}

TEST(TeamSize, AutoIsPodmBelowTheCrossover) {
  EXPECT_EQ(size_of(Algorithm::kAuto, {.threads = 3}, {0, 0, 0}, 4).algorithm, Algorithm::kPodm);
  EXPECT_EQ(size_of(Algorithm::kAuto, {.threads = 4}, {0, 0, 0, 0}, 4).algorithm, Algorithm::kPodmHome);
  EXPECT_EQ(size_of(Algorithm::kPdr, {.threads = 4}, {0, 0, 0, 0}).algorithm, Algorithm::kPdr);
}

TEST(TeamSize, PdrPodmIsPodmBelowTheCrossover) {
  const TeamSize below = size_of(Algorithm::kPdrPodm, {.threads = 4, .nodes = 2}, {0, 0, 5, 5}, 5);
  EXPECT_EQ(below.algorithm, Algorithm::kPodm);
  EXPECT_EQ(below.num_nodes, 1);
  const TeamSize from_it_on = size_of(Algorithm::kPdrPodm, {.threads = 4, .nodes = 2}, {0, 0, 5, 5}, 4);
  EXPECT_EQ(from_it_on.algorithm, Algorithm::kPdrPodm);
  EXPECT_EQ(from_it_on.num_nodes, 2);
}

TEST(TeamSize, AutoWithoutACrossoverIsPodmOnOneNumaNode) {
  EXPECT_EQ(size_of(Algorithm::kAuto, {.threads = 4}, {5, 5, 5, 5}, 0).algorithm, Algorithm::kPodm);
  const TeamSize of_two = size_of(Algorithm::kAuto, {.threads = 4}, {0, 0, 5, 5}, 0);
  EXPECT_EQ(of_two.algorithm, Algorithm::kPodmHome);
  EXPECT_EQ(of_two.num_nodes, 2);
  for (const std::vector<int>& nodes : {std::vector{0, 5, 0, 5}, {0, 0, 0, 5}})
    EXPECT_EQ(size_of(Algorithm::kAuto, {.threads = 4}, nodes, 0).algorithm, Algorithm::kPodm);
  EXPECT_EQ(size_of(Algorithm::kAuto, {.threads = 3}, {0, 0, 5}, 0).algorithm, Algorithm::kPodm);
}

TEST(TeamSize, ComputingNodesAreTheNumaNodesInUseWhereTheseDivideTheWorkers) {
  EXPECT_EQ(size_of(Algorithm::kPdrPodm, {.threads = 4}, {0, 0, 5, 5}).num_nodes, 2);
  EXPECT_EQ(size_of(Algorithm::kPdrPodm, {.threads = 3}, {0, 0, 5}).num_nodes, 1);
  EXPECT_EQ(size_of(Algorithm::kPdrPodm, {.threads = 4, .nodes = 4}, {0, 0, 5, 5}).num_nodes, 4);
  EXPECT_EQ(size_of(Algorithm::kPdrPodm, {.threads = 4, .cores_per_node = 4}, {0, 0, 5, 5}).num_nodes, 1);
  EXPECT_EQ(size_of(Algorithm::kPdr, {.threads = 3}, {0, 0, 5}).num_nodes, 3);
  EXPECT_EQ(size_of(Algorithm::kPodm, {.threads = 4}, {0, 0, 5, 5}).num_nodes, 1);
}

TEST(TeamSize, AllWorkersMakeTheInitialMeshUnlessFewerAreAskedFor) {
  EXPECT_EQ(size_of(Algorithm::kPdr, {.threads = 3}, {0, 0, 0}).initial_workers, 3);
  EXPECT_EQ(size_of(Algorithm::kPdr, {.threads = 3, .initial_threads = 2}, {0, 0, 0}).initial_workers, 2);
}

TEST(TeamSize, ContradictionsAreRefused) {
  for (const TeamOptions& good :
       {TeamOptions{}, TeamOptions{.threads = 6, .nodes = 3, .cores_per_node = 2, .initial_threads = 6}})
    EXPECT_NO_THROW(check_team_size(good, Algorithm::kPdrPodm));
  for (const TeamOptions& bad :
       {TeamOptions{.threads = 6, .nodes = 2, .cores_per_node = 2}, TeamOptions{.threads = 6, .nodes = 4},
        TeamOptions{.threads = 6, .cores_per_node = 4}, TeamOptions{.threads = 6, .initial_threads = 7},
        TeamOptions{.nodes = 2, .initial_threads = 3}})
    EXPECT_THROW(check_team_size(bad, Algorithm::kPdrPodm), InputError);
  EXPECT_THROW(check_team_size({.cores_per_node = 2}, Algorithm::kPdr), InputError);
}

}  // namespace
}  // namespace podm::test
