#pragma once

#include "bench/scenes/moving_pairs.h"

#include <cstddef>
#include <span>
#include <string>

namespace winnow::bench {

/// When the bodies of a pair meet, as an engine says it.
struct ImpactAnswer {
  bool hit = false;
  double time = 1.0;
};

/// Anything that says when pairs of moving bodies first meet: winnow or another library. As
/// NarrowEngine.
class ImpactEngine {
 public:
  ImpactEngine(const ImpactEngine&) = delete;
  ImpactEngine& operator=(const ImpactEngine&) = delete;
  virtual ~ImpactEngine() = default;

  /// Short and stable, e.g. "winnow" or "Bullet continuous".
  [[nodiscard]] virtual std::string name() const = 0;
  /// True if it has a way to answer such pairs.
  [[nodiscard]] virtual bool takes(const PairKind& kind, PairTurn turn) const = 0;
  /// Makes everything ready. Called once, before any run; `set` outlives the engine.
  virtual void start(const MovingPairSet& set) = 0;
  /// Answers some of the set's pairs.
  virtual void run(std::span<const BodyPair> pairs) = 0;
  /// What the last run said of its pair i.
  [[nodiscard]] virtual ImpactAnswer answer(std::size_t i) const = 0;

 protected:
  ImpactEngine() = default;
};

}  // namespace winnow::bench
