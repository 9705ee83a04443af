// Checkpoints are read as they were written, or refused by name.
#include "distributed/checkpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "distributed/in_process_ranks.h"
#include "tests/fault_of.h"
#include "tests/full_disk.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::vector<Fact> kFacts{{"radius", "2 mm"}, {"image", "SHA-256 12"}};

std::vector<LearntVertex> vertices_of(int rank, std::size_t count = 5) {
  std::vector<LearntVertex> vertices;
  for (std::size_t i = 0; i < count; ++i)
    vertices.push_back({{1.0 / static_cast<double>(i + 1), -0.0, 1e-300 * rank},
                        i % 2 == 0 ? VertexKind::kIsosurface : VertexKind::kCircumcenter});
  return vertices;
}

bool are_equal(const std::vector<LearntVertex>& a, const std::vector<LearntVertex>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
    return one.point == other.point && one.kind == other.kind;
  });
}

// Returns all files that differ from this one in their length, or in one bit.
std::vector<std::string> damaged(const std::string& bytes) {
  std::vector<std::string> files{bytes + "\n", bytes + bytes};
  for (std::size_t length = 0; length < bytes.size(); ++length) files.push_back(bytes.substr(0, length));
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      files.push_back(bytes);
      files.back()[at] = static_cast<char>(files.back()[at] ^ (1 << bit));
    }
  return files;
}

class CheckpointFiles : public testing::Test {
 protected:
  /// Writes a checkpoint of `num_ranks` ranks.
  void write(int num_ranks, std::size_t vertices_of_each = 5, double seconds = 0) {
    run_ranks({.num_ranks = num_ranks}, [&](Communication& ranks) {
      Checkpoints checkpoints({.folder = path_, .seconds = seconds}, kFacts, ranks);
      checkpoints.write(vertices_of(ranks.rank(), vertices_of_each), 3);
    });
  }
  /// Returns the vertices of all ranks that resume.
  std::vector<LearntVertex> read(int num_ranks, const std::vector<Fact>& facts = kFacts) {
    std::vector<LearntVertex> all;
    run_ranks({.num_ranks = num_ranks, .one_at_a_time = true}, [&](Communication& ranks) {
      const Checkpoints checkpoints({.folder = path_, .is_resumed = true}, facts, ranks);
      const std::vector<LearntVertex> own = checkpoints.read();
      all.insert(all.end(), own.begin(), own.end());
    });
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return lexicographically_less(a.point, b.point); });
    return all;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  const ScratchFolder folder_;
  const std::string path_ = folder_ / "saved";
};

TEST_F(CheckpointFiles, TextsAreReadAsWrittenOrRefused) {
  const CheckpointText text{
      .facts = kFacts, .number = 4, .rounds = 7, .pieces = {{2, 66, "ab"}, {0, 16, "cd"}}};
  const std::string file = file_of(text);
  EXPECT_EQ(read_checkpoint_text("a.txt", file), text);
  for (const std::string& other : damaged(file))
    EXPECT_THAT(fault_of<InputError>([&] { read_checkpoint_text("a.txt", other); }), StartsWith("a.txt: "));
}

TEST_F(CheckpointFiles, PiecesAreReadAsWrittenOrRefused) {
  const std::string path = folder_ / "piece";
  const std::vector<LearntVertex> vertices = vertices_of(1);
  const CheckpointPiece piece = write_checkpoint_piece(path, vertices);
  EXPECT_TRUE(are_equal(read_checkpoint_piece(path, piece), vertices));
  for (const std::string& other : damaged(bytes_of_file(path))) {
    folder_.write("piece", other);
    EXPECT_THAT(fault_of<InputError>([&] { read_checkpoint_piece(path, piece); }), StartsWith(path + ": "));
  }
  EXPECT_THAT(fault_of<InputError>([&] { read_checkpoint_piece(folder_ / "none", piece); }),
              HasSubstr("No such file"));
  CheckpointPiece another = write_checkpoint_piece(path, vertices);
  ++another.vertices;
  EXPECT_THAT(fault_of<InputError>([&] { read_checkpoint_piece(path, another); }),
              HasSubstr("it has 5 vertices, not 6"));
}

TEST_F(CheckpointFiles, AnyNumberOfRanksReadsEveryVertexOnce) {
  write(3);
  const std::vector<LearntVertex> by_one = read(1);
  EXPECT_EQ(by_one.size(), 15u);
  for (const int num_ranks : {2, 3, 5}) EXPECT_TRUE(are_equal(read(num_ranks), by_one)) << num_ranks;
}

TEST_F(CheckpointFiles, OfAnEarlierCheckpointNothingIsLeft) {
  write(4);
  write(2);
  EXPECT_EQ(names(),
            (std::vector<std::string>{"checkpoint.txt", "lock", "vertices_2_0.bin", "vertices_2_1.bin"}));
  EXPECT_EQ(read(3).size(), 10u);
}

TEST_F(CheckpointFiles, PiecesWithoutTheirTextAreNoCheckpoint) {
  write(2);
  const std::vector<LearntVertex> last = read(1);
  for (int rank = 0; rank < 3; ++rank)
    write_checkpoint_piece(path_ + "/vertices_2_" + std::to_string(rank) + ".bin", vertices_of(rank, 9));
  EXPECT_TRUE(are_equal(read(3), last));
  write(1);
  EXPECT_EQ(names(), (std::vector<std::string>{"checkpoint.txt", "lock", "vertices_3_0.bin"}));
  EXPECT_EQ(read(2).size(), 5u);
}

TEST_F(CheckpointFiles, WhatIsRefusedIsNamed) {
  const auto fault = [&](const std::vector<Fact>& facts = kFacts) {
    return fault_of<InputError>([&] { read(2, facts); });
  };
  EXPECT_THAT(fault(), HasSubstr("saved: the folder has no whole checkpoint"));
  EXPECT_FALSE(std::filesystem::exists(path_));
  const std::string too_long = folder_ / std::string(1000, 'a');
  const auto resume = [&](Communication& ranks) {
    Checkpoints({.folder = too_long, .is_resumed = true}, kFacts, ranks);
  };
  EXPECT_THAT(fault_of<InputError>([&] { run_ranks({.num_ranks = 2}, resume); }),
              HasSubstr("aa/checkpoint.txt: cannot read: "));
  write(2);
  EXPECT_THAT(fault({{"radius", "3 mm"}, kFacts[1]}), HasSubstr("the radius of this run: 2 mm, not 3 mm"));
  EXPECT_THAT(fault({kFacts[0], {"image", "SHA-256 34"}}), HasSubstr("the image of this run"));
  std::filesystem::resize_file(path_ + "/vertices_1_1.bin", 100);
  EXPECT_THAT(fault(), HasSubstr("vertices_1_1.bin: it has 100 bytes, not 141"));
}

TEST_F(CheckpointFiles, AFullDiskLeavesTheLastCheckpoint) {
  write(2);
  {
    const FullDisk full(1 << 10);
    const std::string fault = fault_of<InputError>([&] { write(2, 1000); });
    EXPECT_THAT(fault, HasSubstr("cannot write"));
    EXPECT_THAT(fault, HasSubstr("saved/vertices_2_"));
  }
  EXPECT_EQ(read(1).size(), 10u);
  EXPECT_EQ(names().size(), 4u);
}

TEST_F(CheckpointFiles, TwoRunsDoNotShareAFolder) {
  run_ranks({.num_ranks = 1}, [&](Communication& ranks) {
    const Checkpoints checkpoints({.folder = path_}, kFacts, ranks);
    EXPECT_THAT(fault_of<InputError>([&] { Checkpoints({.folder = path_}, kFacts, ranks); }),
                HasSubstr("another run"));
  });
  write(1);
}

TEST_F(CheckpointFiles, TheyAreDueAfterTheirSeconds) {
  run_ranks({.num_ranks = 2}, [&](Communication& ranks) {
    EXPECT_TRUE(Checkpoints({.folder = path_, .seconds = 0}, kFacts, ranks).is_due());
    EXPECT_FALSE(Checkpoints({.folder = path_, .seconds = 1000}, kFacts, ranks).is_due());
  });
}

}  // namespace
}  // namespace podm::test
