#pragma once

#include "pipeline/composites/composites.h"

#include <span>

namespace winnow::mid {

/// See MidPhase::expand. `all` may be null: there are no composite shapes then. O(pairs of bodies +
/// pairs of primitives, each with a walk of O(log n + found)).
///
/// Fixed chunks of pairs of bodies are searched as tasks, which write numbers to shared room; then
/// what they found is counted, and the same chunks write it out where it belongs. Neither depends
/// on how many threads there are.
Status expand(const Composites* all, const ShapeTables& tables, const Bodies& bodies,
              std::span<const BodyPair> pairs, double margin, const Execution& execution,
              PrimitivePairs& out);

}  // namespace winnow::mid
