// Faults that all ranks learn before any rank goes on, so that all ranks can end in the regular way.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "distributed/communication.h"

namespace podm {

/// All ranks throw it with the same text. One rank may report it, and no rank waits for another.
class RefusedByAll : public InputError {
 public:
  using InputError::InputError;
};

/// Collective. Calls action(), which must not be collective. Then throws RefusedByAll on all ranks if
/// action() threw InputError on any rank. The text is that of the first such rank, after the rank's number
/// unless all ranks have the same text. Other exceptions pass through.
void do_collectively(const std::function<void()>& action, Communication& ranks);

/// A name and a text.
using Fact = std::pair<std::string, std::string>;
/// Collective. Throws RefusedByAll that names rank and fact, unless all ranks have the same facts.
void expect_agreement(const std::vector<Fact>& facts, Communication& ranks);

}  // namespace podm
