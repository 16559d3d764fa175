#pragma once

#include "bench/common/interface.h"
#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace winnow::bench {

/// An engine's result for one pair. Members that the engine does not compute keep these defaults.
struct NarrowAnswer {
  bool overlap = false;
  std::uint32_t contacts = 0;
  /// Negative if the bodies overlap, by the penetration depth.
  double distance = std::numeric_limits<double>::quiet_NaN();
  /// NaN if the engine returns none.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Unit length, from a to b; zero if the engine returns none.
  double normal[3] = {0.0, 0.0, 0.0};
  /// A point on a, in world coordinates.
  double point[3] = {0.0, 0.0, 0.0};
};

/// Base of everything that computes contacts of pairs of bodies: winnow and other libraries. The
/// harness times `run` from outside. Shapes and poses have been converted to the engine's types
/// before, as in a simulation that uses the engine. Nothing is cached per pair between runs.
class NarrowEngine : public Interface {
 public:
  /// A short constant name, e.g. "robust" or "FCL libccd".
  [[nodiscard]] virtual std::string name() const = 0;
  /// True if the engine supports such pairs at the level.
  [[nodiscard]] virtual bool takes(const PairKind& kind, ContactLevel level) const = 0;
  /// Prepares everything. Called once, before any run; `set` outlives the engine.
  virtual void start(const PairSet& set) = 0;
  /// Computes some of the set's pairs.
  virtual void run(ContactLevel level, std::span<const BodyPair> pairs) = 0;
  /// Returns the result for pair i of the last run.
  [[nodiscard]] virtual NarrowAnswer answer(std::size_t i) const = 0;
  /// Share of the pairs of the last run that were computed a second time; NaN if unavailable.
  [[nodiscard]] virtual double recomputed() const {
    return std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace winnow::bench
