// A run on ranks: every rank reports the same whole mesh, and the pieces add up to it.
#include "distributed/mesh_image_on_ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <regex>

#include "distributed/collective_errors.h"
#include "distributed/in_process_ranks.h"
#include "tests/fault_of.h"
#include "tests/images.h"

namespace podm::test {
namespace {

MeshingOptions options_with_radius(double radius_mm) {
  MeshingOptions options;
  options.sizes.radius_mm = radius_mm;
  options.team.threads = 1;
  return options;
}

class MeshImageOnRanks : public testing::TestWithParam<int> {};

TEST_P(MeshImageOnRanks, PiecesAddUpToTheWholeThatAllRanksReport) {
  const auto num_ranks = static_cast<std::size_t>(GetParam());
  const LabelImage image = ball(24, 9);
  std::vector<MeshingOnRanks> results(num_ranks);
  run_ranks({.num_ranks = GetParam(), .one_at_a_time = true}, [&](Communication& ranks) {
    results[static_cast<std::size_t>(ranks.rank())] =
        mesh_image_on_ranks(image, options_with_radius(1.5), ranks);
  });
  std::uint64_t cells = 0, facets = 0;
  std::vector<int> owners(results[0].piece.total_vertices);
  for (const MeshingOnRanks& result : results) {
    const MeshPiece& piece = result.piece;
    EXPECT_EQ(piece.first_cell, cells);
    EXPECT_EQ(piece.first_facet, facets);
    cells += piece.mesh.cells.size();
    facets += piece.mesh.facets.size();
    ASSERT_EQ(piece.vertex_ids.size(), piece.mesh.vertices.size());
    ASSERT_EQ(piece.owns_vertex.size(), piece.mesh.vertices.size());
    for (std::size_t v = 0; v < piece.vertex_ids.size(); ++v)
      owners.at(piece.vertex_ids[v]) += piece.owns_vertex[v];
    EXPECT_TRUE(result.report.guarantees.all_met());
    EXPECT_EQ(result.report.cells_of_label, results[0].report.cells_of_label);
    EXPECT_EQ(result.report.counters.num_committed(), results[0].report.counters.num_committed());
    EXPECT_EQ(result.report.workers.size(), num_ranks);
    EXPECT_EQ(result.parts.size(), num_ranks);
  }
  EXPECT_EQ(results[0].report.cells_of_label.at(image.labels[1].value), cells);
  EXPECT_EQ(results[0].piece.total_cells, cells);
  EXPECT_EQ(results[0].piece.total_facets, facets);
  EXPECT_TRUE(std::all_of(owners.begin(), owners.end(), [](int count) { return count == 1; }));
}

// The network is so slow that it takes nearly all of the time, so that no phase can lose a collective
// unnoticed.
TEST_P(MeshImageOnRanks, PhasesAddUpToWhatEachRankSpent) {
  const LabelImage image = ball(24, 9);
  std::vector<PartOfRank> parts;
  std::vector<double> until_end_s(static_cast<std::size_t>(GetParam()));
  run_ranks({.num_ranks = GetParam(), .one_at_a_time = true, .latency_s = 100}, [&](Communication& ranks) {
    const double start_s = ranks.report().total_s();
    MeshingOnRanks result = mesh_image_on_ranks(image, options_with_radius(1.5), ranks);
    until_end_s[static_cast<std::size_t>(ranks.rank())] = ranks.report().total_s() - start_s;
    if (ranks.rank() == 0) parts = std::move(result.parts);
  });
  for (std::size_t rank = 0; rank < parts.size(); ++rank) {
    double sum_s = 0;
    for (const auto& [phase, spent] : parts[rank].spent) {
      sum_s += spent.computing_s + spent.waiting_s + spent.network_s;
      EXPECT_GE(spent.computing_s, 0) << phase;
    }
    EXPECT_EQ(parts[rank].spent.count("later") > 0, parts[rank].rounds.size() > 1);
    EXPECT_GT(parts[rank].spent.at("refine").computing_s, 0);
    // Time of the collectives before the first phase and after the last.
    const double collectives_s = GetParam() == 1 ? 0 : 100 * (6 * std::bit_width(parts.size() - 1));
    EXPECT_LE(sum_s, until_end_s[rank]);
    EXPECT_NEAR(sum_s, until_end_s[rank], collectives_s + 0.5);
  }
}

// A tolerance of half a percent requires more than one mesh. The times of all meshes add up to what the ranks
// spent.
TEST_P(MeshImageOnRanks, MeetATargetNumberOfCellsTogether) {
  constexpr std::uint64_t kTarget = 20'000;
  const LabelImage image = ball(40, 15);
  MeshingOptions options = options_with_radius(0);
  options.sizes.target_elements = kTarget;
  options.sizes.target_tolerance_percent = 0.5;
  std::vector<MeshingOnRanks> results(static_cast<std::size_t>(GetParam()));
  // Time of the collectives before the first phase and after the last.
  const double before_and_after_s =
      GetParam() == 1 ? 0.5 : 100 * 6 * std::bit_width(results.size() - 1) + 0.5;
  run_ranks({.num_ranks = GetParam(), .one_at_a_time = true, .latency_s = 100}, [&](Communication& ranks) {
    const double start_s = ranks.report().total_s();
    MeshingOnRanks& result = results[static_cast<std::size_t>(ranks.rank())];
    result = mesh_image_on_ranks(image, options, ranks);
    const double spent_s = ranks.report().total_s() - start_s;
    double sum_s = 0;
    for (const auto& [phase, spent] : result.parts.at(static_cast<std::size_t>(ranks.rank())).spent)
      sum_s += spent.computing_s + spent.waiting_s + spent.network_s;
    EXPECT_LE(sum_s, spent_s);
    EXPECT_GE(sum_s, spent_s - before_and_after_s);
  });
  for (const MeshingOnRanks& result : results) {
    EXPECT_NEAR(static_cast<double>(result.piece.total_cells), 1.0 * kTarget, 0.005 * kTarget);
    const Calibration& calibration = result.report.calibration.value();
    EXPECT_GT(calibration.meshes.size(), 0u);
    EXPECT_EQ(calibration.radius_mm, result.report.radius_mm);
    EXPECT_EQ(calibration.radius_mm, results[0].report.radius_mm);
    EXPECT_TRUE(result.report.guarantees.all_met());
    EXPECT_TRUE(result.report.warnings.empty());
    if (GetParam() > 1) {
      EXPECT_GT(result.parts[0].spent.at("calibrate").network_s, 0);
    }
  }
  // A mesh of the radius that was found has the same number of cells.
  run_ranks({.num_ranks = GetParam(), .one_at_a_time = true}, [&](Communication& ranks) {
    const MeshingOnRanks made =
        mesh_image_on_ranks(image, options_with_radius(results[0].report.radius_mm), ranks);
    EXPECT_EQ(made.piece.total_cells, results[0].piece.total_cells);
  });
}

INSTANTIATE_TEST_SUITE_P(Ranks, MeshImageOnRanks, testing::Values(1, 3, 4));

TEST(RanksOfOneProcess, ShareAnIsosurfaceAndAreEachChargedWithIt) {
  const LabelImage image = ball(24, 9);
  std::vector<MeshingOnRanks> apart(3), together(3);
  SharedInProcess shared;
  for (auto* results : {&apart, &together})
    run_ranks({.num_ranks = 3}, [&](Communication& ranks) {
      (*results)[static_cast<std::size_t>(ranks.rank())] = mesh_image_on_ranks(
          image, options_with_radius(1.5), ranks, {}, {}, results == &together ? &shared : nullptr);
    });
  for (std::size_t rank = 0; rank < 3; ++rank) {
    EXPECT_EQ(together[rank].piece.mesh.cells, apart[rank].piece.mesh.cells);
    EXPECT_GT(together[0].parts[rank].phases_s.at("transform"), 0);
  }
}

TEST(SharedValue, IsMadeOnceWhenThatFailsTheFirstTimeAndChargedToAll) {
  SharedValue<int> seven;
  int num_made = 0, num_failed = 0;
  const auto reports = run_ranks({.num_ranks = 4, .one_at_a_time = true}, [&](Communication& ranks) {
    const auto make = [&] {
      if (num_failed++ == 0) throw InputError("not yet");
      ++num_made;
      ranks.charge(100);
      return std::make_shared<const int>(7);
    };
    try {
      EXPECT_EQ(*seven.get(make, ranks), 7);
    } catch (const InputError&) {
      EXPECT_EQ(*seven.get(make, ranks), 7);
    }
  });
  EXPECT_EQ(num_made, 1);
  for (const RankReport& report : reports) EXPECT_GE(report.computing_s, 100);
}

// Returns the text of the exception that all ranks throw.
std::string refusal_by_all(const std::function<void(Communication&)>& body) {
  std::vector<std::string> words(3);
  run_ranks({.num_ranks = 3}, [&](Communication& ranks) {
    words[static_cast<std::size_t>(ranks.rank())] = fault_of<RefusedByAll>([&] { body(ranks); });
  });
  EXPECT_EQ(words[0], words[1]);
  EXPECT_EQ(words[0], words[2]);
  return words[0];
}

TEST(RanksThatDiffer, AreRefusedByAllWithTheRankAndWhatDiffers) {
  const LabelImage image = ball(12, 4), other = ball(12, 3);
  const auto with_radius_of_rank = [&](Communication& ranks) {
    mesh_image_on_ranks(image, options_with_radius(ranks.rank() == 2 ? 3 : 4), ranks);
  };
  const auto with_image_of_rank = [&](Communication& ranks) {
    mesh_image_on_ranks(ranks.rank() == 1 ? other : image, options_with_radius(4), ranks);
  };
  EXPECT_NE(refusal_by_all(with_radius_of_rank).find("rank 2 of 3 does not have the radius"),
            std::string::npos);
  EXPECT_NE(refusal_by_all(with_image_of_rank).find("rank 1 of 3 does not have the image"),
            std::string::npos);
}

TEST(RanksThatDiffer, AreRefusedByAllWhereLeavesDoNotFitInTheMemoryOfOne) {
  const LabelImage image = ball(12, 4);
  EXPECT_NE(refusal_by_all([&](Communication& ranks) {
              MeshingOptions options = options_with_radius(1);
              options.algorithm = Algorithm::kPdrPodm;
              options.leaves.size_mm = 0.3;
              options.limits.max_memory_bytes = ranks.rank() == 1 ? 64 << 20 : 1 << 30;
              mesh_image_on_ranks(image, options, ranks);
            }).find("rank 1 of 3: a leaf size of 0.3 mm gives"),
            std::string::npos);
}

// In the first memory in which a rank alone exceeds its part, sharing lets all of them finish.
TEST(RanksOfOneProcess, ShareMemoryByNeed) {
  constexpr int kRanks = 4;
  const LabelImage image = ball(24, 9);
  const auto is_complete_in = [&](std::uint64_t bytes, SharedInProcess* shared) {
    MeshingOptions options = options_with_radius(0.8);
    options.limits.max_memory_bytes = bytes;
    bool is_complete = false;
    try {
      run_ranks({.num_ranks = kRanks, .one_at_a_time = true}, [&](Communication& ranks) {
        const MeshingOnRanks made = mesh_image_on_ranks(image, options, ranks, {}, {}, shared);
        if (ranks.rank() == 0) is_complete = made.report.stop_reason == StopReason::kComplete;
      });
    } catch (const std::bad_alloc&) {  // between rounds
    }
    return is_complete;
  };
  std::uint64_t bytes = 10 << 20;
  while (is_complete_in(bytes, nullptr)) bytes = bytes / 32 * 31;
  SharedInProcess shared, little;
  EXPECT_TRUE(is_complete_in(bytes, &shared));
  EXPECT_FALSE(is_complete_in(bytes / 4, &little));
}

// The seeds take more than the store has.
TEST(RanksWithoutMemory, NameTheNumberOfRanksThatWouldDo) {
  MeshingOptions options = options_with_radius(0.4);
  options.limits.max_memory_bytes = 1 << 20;
  const std::string fault = fault_of<std::bad_alloc>([&] {
    run_ranks({.num_ranks = 2},
              [&](Communication& ranks) { mesh_image_on_ranks(ball(24, 9), options, ranks); });
  });
  std::smatch number;
  ASSERT_TRUE(std::regex_search(
      fault, number, std::regex("^rank [01] of 2: out of memory: .* ([0-9]+) or more ranks of this memory")))
      << fault;
  EXPECT_GT(std::stoi(number[1]), 10) << fault;
  EXPECT_LT(std::stoi(number[1]), 1000) << fault;
}

TEST(DoCollectively, NamesTheRankUnlessAllHaveTheSameError) {
  EXPECT_EQ(refusal_by_all([](Communication& ranks) {
              do_collectively([] { throw InputError("no such file"); }, ranks);
            }),
            "no such file");
  const auto fail_on_one = [](Communication& ranks) {
    do_collectively(
        [&] {
          if (ranks.rank() == 1) throw InputError("disk full");
        },
        ranks);
  };
  EXPECT_EQ(refusal_by_all(fail_on_one), "rank 1 of 3: disk full");
}

}  // namespace
}  // namespace podm::test
