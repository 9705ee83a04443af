// Test cases for every implementation of the communication. Each case is called on all ranks and checks with
// EXPECT.
#pragma once

#include "distributed/communication.h"

namespace podm::test {

/// Calls random collectives, the same on all ranks, with random messages that every rank can predict.
void expect_random_collectives(Communication& communication, std::uint64_t seed, int num_collectives);
/// Sends messages of zero, one and many bytes. Some have the limit of one call, a byte less, and a byte more.
void expect_lengths(Communication& communication, std::size_t most_bytes);
void expect_one_message_per_rank(Communication& communication);
/// Checks, on this machine's clock, that no rank goes on before the last rank has arrived.
void expect_barrier(Communication& communication);
/// Checks that the largest announced value reaches all ranks. Announcements need not arrive before a
/// collective if they arrive `with_collectives`. The last ones are never looked for.
void expect_announcements(Communication& communication, bool with_collectives);

}  // namespace podm::test
