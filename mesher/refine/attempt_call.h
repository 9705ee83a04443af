// How the virtual executor carries an attempt out: at once, or with PODM_INTERLEAVING (delaunay/step.h) in
// parts, between which others go on.
#pragma once

#include <optional>
#include <random>

#ifdef PODM_INTERLEAVING
#include <cmath>

#include "runtime/fibre.h"
#endif

namespace podm {

#ifdef PODM_INTERLEAVING

class AttemptCall {
 public:
  static constexpr bool kIsInParts = true;

  template <class Call>
  void begin(const Call& call) {
    fibre_.begin(call);
    most_steps_ = 0;
  }
  bool has_ended() const { return fibre_.has_ended(); }
  /// Goes on; the seconds that it stops then, or nothing when it has ended. Some attempts stop at many
  /// steps, some at few. Most stops are short, and a few so long that others carry out whole operations.
  std::optional<double> go_on(std::mt19937_64& random) {
    if (most_steps_ == 0) most_steps_ = 1u << std::uniform_int_distribution(3, 9)(random);
    if (fibre_.resume(std::uniform_int_distribution(1u, most_steps_)(random))) return std::nullopt;
    return 1e-9 * std::exp(std::uniform_real_distribution(0.0, 12.0)(random));
  }
  void finish() { fibre_.resume(~std::uint64_t{0}); }

 private:
  Fibre fibre_;
  unsigned most_steps_ = 0;  // of a part; drawn when the call begins
};

#else

class AttemptCall {
 public:
  static constexpr bool kIsInParts = false;

  template <class Call>
  void begin(const Call& call) {
    call();
  }
  static constexpr bool has_ended() { return true; }
  static std::optional<double> go_on(std::mt19937_64&) { return std::nullopt; }
  static constexpr void finish() {}
};

#endif

}  // namespace podm
