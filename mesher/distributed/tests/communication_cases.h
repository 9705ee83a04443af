// What any carrier of messages must do: each case is called on all ranks, and expects.
#pragma once

#include "distributed/communication.h"

namespace podm::test {

/// Random collectives, the same on all ranks, of random messages that every rank can predict.
void expect_random_collectives(Communication& communication, std::uint64_t seed, int num_collectives);
/// Messages of none, one and many bytes, some as long as one call of a carrier takes, a byte less and a byte
/// more.
void expect_lengths(Communication& communication, std::size_t most_bytes);
void expect_one_message_a_rank(Communication& communication);
/// No rank goes on before the last has come, on this machine's clock.
void expect_barrier(Communication& communication);

}  // namespace podm::test
