#pragma once

#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace winnow::bench {

/// What an engine says of one pair; what it was not asked, or cannot tell, stays as it is here.
struct NarrowAnswer {
  bool overlap = false;
  std::uint32_t contacts = 0;
  /// Negative by the penetration depth.
  double distance = std::numeric_limits<double>::quiet_NaN();
  /// NaN: none is given.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Unit, from a to b; zero if none is given.
  double normal[3] = {0.0, 0.0, 0.0};
  /// On a, in world coordinates.
  double point[3] = {0.0, 0.0, 0.0};
};

/// Anything that answers pairs of bodies: winnow or another library. The harness times `run` from
/// outside; shapes and poses are in the engine's own form by then, as in a simulation that uses it.
/// Nothing is remembered of a pair from run to run.
class NarrowEngine {
 public:
  NarrowEngine(const NarrowEngine&) = delete;
  NarrowEngine& operator=(const NarrowEngine&) = delete;
  virtual ~NarrowEngine() = default;

  /// Short and stable, e.g. "robust" or "FCL libccd".
  [[nodiscard]] virtual std::string name() const = 0;
  /// True if it has a way to answer such pairs at the level.
  [[nodiscard]] virtual bool takes(const PairKind& kind, ContactLevel level) const = 0;
  /// Makes everything ready. Called once, before any run; `set` outlives the engine.
  virtual void start(const PairSet& set) = 0;
  /// Answers some of the set's pairs.
  virtual void run(ContactLevel level, std::span<const BodyPair> pairs) = 0;
  /// What the last run said of its pair i.
  [[nodiscard]] virtual NarrowAnswer answer(std::size_t i) const = 0;
  /// Share of the pairs of the last run that were computed a second time; NaN: cannot tell.
  [[nodiscard]] virtual double recomputed() const {
    return std::numeric_limits<double>::quiet_NaN();
  }

 protected:
  NarrowEngine() = default;
};

}  // namespace winnow::bench
