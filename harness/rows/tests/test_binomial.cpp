// Tests of intervals of shares by the definition of Clopper and Pearson, and against closed forms.
#include "rows/binomial.h"

#include <gtest/gtest.h>

#include <cmath>

namespace podm::bench {
namespace {

TEST(ClopperPearson, OfAllOrNoneHasAClosedForm) {
  for (const int tries : {1, 5, 20, 300}) {
    const double bound = std::pow(0.025, 1.0 / tries);
    const ShareInterval all = clopper_pearson(tries, tries), none = clopper_pearson(0, tries);
    EXPECT_NEAR(all.low, bound, 1e-9) << tries;
    EXPECT_EQ(all.high, 1);
    EXPECT_EQ(none.low, 0);
    EXPECT_NEAR(none.high, 1 - bound, 1e-9) << tries;
  }
}

TEST(ClopperPearson, OfTenOfTwentyIsThePublishedOne) {
  const ShareInterval interval = clopper_pearson(10, 20);
  EXPECT_NEAR(interval.low, 0.27196, 1e-5);
  EXPECT_NEAR(interval.high, 0.72804, 1e-5);
}

TEST(ClopperPearson, IsMirroredByFailuresAndHoldsTheShare) {
  for (int successes = 0; successes <= 17; ++successes) {
    const ShareInterval interval = clopper_pearson(successes, 17),
                        mirrored = clopper_pearson(17 - successes, 17);
    EXPECT_NEAR(interval.low, 1 - mirrored.high, 1e-9);
    EXPECT_LE(interval.low, successes / 17.0);
    EXPECT_GE(interval.high, successes / 17.0);
  }
}

TEST(ClopperPearson, WithoutATryIsEverything) {
  EXPECT_EQ(clopper_pearson(0, 0).low, 0);
  EXPECT_EQ(clopper_pearson(0, 0).high, 1);
}

}  // namespace
}  // namespace podm::bench
