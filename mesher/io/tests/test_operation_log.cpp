// Linearization logs read back in sequence, in whatever order batches were written. Damaged files are
// refused, and unfinished logs leave no file.
#include "podm/operation_log.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "podm/errors.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

class OperationLogFile : public testing::Test {
 protected:
  ScratchFolder folder_;
  std::string path_ = folder_ / "run.log";
  const OperationLogHead head_{{0, -1, 2.5, 1. / 3, 1e-9, 7}, "ab12", "LPS", "cd34"};

  // Writes batches of several workers in arbitrary order; sequence numbers have gaps.
  void write(std::size_t count, unsigned seed) {
    OperationLogWriter writer(path_);
    std::mt19937 random(seed);
    std::vector<OperationBatch> batches(3);
    for (std::uint64_t sequence = 0; sequence < count; ++sequence) {
      if (random() % 4 == 0) continue;
      OperationBatch& batch = batches[random() % 3];
      const auto num_removed = static_cast<std::uint32_t>(random() % 3);
      batch.operations.push_back(
          {sequence, {1. / (1 + static_cast<double>(sequence)), -0.0, 3}, 7, 2, 3, num_removed});
      for (std::uint32_t r = 0; r < num_removed; ++r)
        batch.removed.push_back(static_cast<std::uint32_t>(10 * sequence + r));
      if (batch.operations.size() == 5) {
        writer.append(batch);
        batch = {};
      }
    }
    for (const OperationBatch& batch : batches) writer.append(batch);
    writer.finish(head_);
    writer.publish();
  }

  std::string bytes() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void overwrite(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
};

TEST_F(OperationLogFile, ReadsBackInSequence) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{200}}) {
    write(count, 5);
    const OperationLog log = read_operation_log(path_);
    EXPECT_EQ(log.head.box, head_.box);
    EXPECT_EQ(log.head.image_sha256, head_.image_sha256);
    EXPECT_EQ(log.head.space, head_.space);
    EXPECT_EQ(log.head.mesh_sha256, head_.mesh_sha256);
    std::size_t next_removed = 0;
    for (std::size_t i = 0; i < log.all.operations.size(); ++i) {
      const LoggedOperation& operation = log.all.operations[i];
      if (i > 0) {
        EXPECT_LT(log.all.operations[i - 1].sequence, operation.sequence);
      }
      EXPECT_EQ(operation.point[0], 1. / (1 + static_cast<double>(operation.sequence)));
      for (std::uint32_t r = 0; r < operation.num_removed; ++r)
        EXPECT_EQ(log.all.removed.at(next_removed++), 10 * operation.sequence + r);
    }
    EXPECT_EQ(next_removed, log.all.removed.size());
  }
}

TEST_F(OperationLogFile, OfARankNamesItsRank) {
  OperationLogHead head = head_;
  head.mesh_sha256.clear();
  head.mesh_hash = "ef56";
  head.rank = 2;
  head.num_ranks = 3;
  const auto write_and_read = [&] {
    OperationLogWriter writer(path_);
    writer.finish(head);
    writer.publish();
    return read_operation_log(path_).head;
  };
  const OperationLogHead read = write_and_read();
  EXPECT_EQ(read.mesh_hash, head.mesh_hash);
  EXPECT_EQ(read.rank, 2);
  EXPECT_EQ(read.num_ranks, 3);
  for (const int rank : {-1, 3}) {
    head.rank = rank;
    EXPECT_THROW(write_and_read(), InputError) << rank;
  }
}

TEST_F(OperationLogFile, CountsStepsAndWhatIsInThem) {
  OperationLogWriter writer(path_);
  EXPECT_EQ(operation_text(writer.least_sequence()), "operation 0");
  writer.set_least_sequence(7);
  EXPECT_EQ(operation_text(writer.least_sequence()), "operation 7");
  writer.begin_step();
  EXPECT_EQ(operation_text(writer.least_sequence()), "operation 0 of step 1");
  writer.begin_step();
  writer.begin_step();
  EXPECT_EQ(step_of(writer.least_sequence()), 3u);
  writer.restart();
  EXPECT_EQ(writer.least_sequence(), 0u);
}

TEST_F(OperationLogFile, AppearsWholeOrNotAtAll) {
  for (const bool is_finished : {false, true}) {
    OperationLogWriter writer(path_);
    writer.append({{LoggedOperation{}}, {}});
    if (is_finished) writer.finish(head_);
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
  EXPECT_TRUE(folder_.files().empty());
}

TEST_F(OperationLogFile, RestartForgets) {
  {
    OperationLogWriter writer(path_);
    writer.append({{LoggedOperation{}}, {}});
    writer.restart();
    writer.finish(head_);
    writer.publish();
  }
  EXPECT_TRUE(read_operation_log(path_).all.operations.empty());
}

TEST_F(OperationLogFile, EveryTruncationIsRefused) {
  write(60, 6);
  const std::string whole = bytes();
  for (std::size_t size = 0; size + 2 < whole.size();
       size += 1 + size / 40) {  // without the last newline the file is still complete
    overwrite(whole.substr(0, size));
    EXPECT_THROW(read_operation_log(path_), InputError) << size << " of " << whole.size() << " bytes";
  }
}

TEST_F(OperationLogFile, DamageIsRefusedOrHarmless) {
  write(60, 7);
  const std::string whole = bytes();
  std::mt19937 random(8);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] = static_cast<char>(random());
    overwrite(damaged);
    try {
      const OperationLog log = read_operation_log(path_);
      std::size_t num_removed = 0;
      for (const LoggedOperation& operation : log.all.operations) num_removed += operation.num_removed;
      EXPECT_EQ(num_removed, log.all.removed.size());
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(path_), std::string::npos);
    }
  }
}

TEST_F(OperationLogFile, DoubledSequenceNumberIsRefused) {
  {
    OperationLogWriter writer(path_);
    writer.append({{LoggedOperation{}, LoggedOperation{}}, {}});
    writer.finish(head_);
    writer.publish();
  }
  EXPECT_THROW(read_operation_log(path_), InputError);
}

}  // namespace
}  // namespace podm::test
