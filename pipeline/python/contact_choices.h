#pragma once

#include "pipeline/python/choices.h"

#include <pybind11/pybind11.h>

#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/narrow_phase.h>

namespace winnow::python {

inline constexpr Choices<ContactLevel, 4> kLevels{{{"pairs", ContactLevel::pairs},
                                                   {"boolean", ContactLevel::boolean},
                                                   {"distance", ContactLevel::distance},
                                                   {"manifold", ContactLevel::manifold}}};
inline constexpr Choices<NarrowTier, 2> kTiers{
    {{"robust", NarrowTier::robust}, {"reference", NarrowTier::reference}}};

[[nodiscard]] inline pybind11::dict narrow_statistics(const NarrowStatistics& s) {
  pybind11::dict result;
  result["pairs"] = s.pairs;
  result["recomputed"] = s.recomputed;
  result["without_lanes"] = s.without_lanes;
  result["exact"] = s.exact;
  result["bounded"] = s.bounded;
  return result;
}

}  // namespace winnow::python
