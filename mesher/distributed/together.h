// Faults that all ranks learn of before any goes on, so that all may end as if they were done.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "distributed/communication.h"

namespace podm {

/// All ranks throw it, in the same words: one may tell of it, and none waits for another.
class RefusedByAll : public InputError {
 public:
  using InputError::InputError;
};

/// Collective. Calls action(), which must not be; then throws RefusedByAll if it has thrown InputError on any
/// rank: with the first such rank's words, after its number unless all ranks say the same. Other exceptions
/// go their way.
void do_together(const std::function<void()>& action, Communication& ranks);

/// A name and a text.
using Fact = std::pair<std::string, std::string>;
/// Collective. Throws RefusedByAll, naming rank and fact, unless all ranks tell the same.
void expect_agreement(const std::vector<Fact>& facts, Communication& ranks);

}  // namespace podm
