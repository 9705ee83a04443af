// The frozen model of virtual time: its hash, which depends on every constant.
#include "runtime/time_costs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <span>

#include "io/sha256.h"

namespace podm::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string hash_of(const TimeCosts& costs) {
  const std::string text = time_model_text(costs);
  Sha256 digest;
  digest.update(std::span(text));
  return digest.hexadecimal();
}

TEST(TimeCosts, AreFrozen) {
  ASSERT_EQ(kTimeModelVersion, 1) << "a new version of the model has a new hash: write both here";
  EXPECT_EQ(hash_of(TimeCosts()), "044d7bd2821e9ac58a3897990b24c88e344bb8842ef40d412e1d87608d1ab7d3")
      << "the model is frozen: rows of two models do not mix. A changed constant or rule needs another\n"
         "kTimeModelVersion (runtime/time_costs.h), its hash here, and rows played anew. It now reads:\n"
      << time_model_text(TimeCosts());
}

TEST(TimeCosts, EachHasANameOfItsOwnAndChangesTheHash) {
  std::set<std::string> names, hashes = {hash_of(TimeCosts())};
  for (const auto& [name, member] : kTimeCosts) {
    TimeCosts doubled;
    EXPECT_GT(doubled.*member, 0) << name;
    doubled.*member *= 2;
    names.insert(name);
    hashes.insert(hash_of(doubled));
  }
  EXPECT_EQ(names.size(), kTimeCosts.size());
  EXPECT_EQ(hashes.size(), kTimeCosts.size() + 1);
}

TEST(TimeCosts, AreWrittenAsTheyAre) {
  TimeCosts costs;
  costs.begging = 1e-3;
  EXPECT_THAT(time_model_text(costs), StartsWith("version 1\nlist_looked_up 1.1e-08\n"));
  EXPECT_THAT(time_model_text(costs), HasSubstr("\nbegging 0.001\n"));
}

}  // namespace
}  // namespace podm::test
