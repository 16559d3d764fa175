#pragma once

#include "bench/common/interface.h"
#include "bench/scenes/moving_pairs.h"

#include <cstddef>
#include <span>
#include <string>

namespace winnow::bench {

/// The time of impact of a pair.
struct ImpactAnswer {
  bool hit = false;
  double time = 1.0;
};

/// Base of everything that computes times of impact of pairs of moving bodies: winnow and other
/// libraries. Used by the harness like NarrowEngine.
class ImpactEngine : public Interface {
 public:
  /// A short constant name, e.g. "winnow" or "Bullet continuous".
  [[nodiscard]] virtual std::string name() const = 0;
  /// True if the engine supports such pairs.
  [[nodiscard]] virtual bool takes(const PairKind& kind, PairTurn turn) const = 0;
  /// Prepares everything. Called once, before any run; `set` outlives the engine.
  virtual void start(const MovingPairSet& set) = 0;
  /// Computes some of the set's pairs.
  virtual void run(std::span<const BodyPair> pairs) = 0;
  /// Returns the result for pair i of the last run.
  [[nodiscard]] virtual ImpactAnswer answer(std::size_t i) const = 0;
};

}  // namespace winnow::bench
