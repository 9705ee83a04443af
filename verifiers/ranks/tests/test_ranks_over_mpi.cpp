// Run on several numbers of ranks by mpirun. Messages of a few bytes stand for those beyond 2^31 bytes.
#include "ranks/ranks_over_mpi.h"

#include "ranks/tests/communication_cases.h"

int main(int argc, char** argv) {
  using namespace podm::verify;
  const MpiSession session(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  for (const std::size_t most_bytes : {std::size_t{1} << 30, std::size_t{5}})
    for (int i = 0; i < 10; ++i) expect_all_of_communication(*ranks_over_mpi(most_bytes));
  EXPECT_GE(ranks_on_this_machine(), 1);
  return testing::UnitTest::GetInstance()->ad_hoc_test_result().Failed() ? 1 : 0;
}
