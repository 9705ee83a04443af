// Tests that all costs of sharing are measured, and that their figures are those of a machine.
#include <gtest/gtest.h>

#include "machine/sharing.h"
#include "process/stopwatch.h"
#include "rows/codec.h"

namespace podm::bench {
namespace {

TEST(Sharing, MeasuresEveryCost) {
  const Json record = to_json(measure_sharing());
  for (const auto& [name, value] : record.items()) EXPECT_GT(value.get<double>(), 0) << name;
}

TEST(Sharing, OrdersTheCosts) {
  if (!seconds_matter()) GTEST_SKIP() << "PODM_BENCH_UNTIMED is set";
  const SharingRecord record = measure_sharing();
  EXPECT_GT(record.page_fault_ns, record.page_touched_again_ns);
  EXPECT_GT(record.mapped_chunk_ns, record.recycled_chunk_ns);
  if (record.processors < 2) GTEST_SKIP() << "one processor";
  EXPECT_GT(record.transfer_ns, record.addition_alone_ns);
}

}  // namespace
}  // namespace podm::bench
