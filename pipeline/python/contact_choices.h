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
  return pybind11::dict(pybind11::arg("pairs") = s.pairs,
                        pybind11::arg("recomputed") = s.recomputed,
                        pybind11::arg("without_lanes") = s.without_lanes,
                        pybind11::arg("exact") = s.exact, pybind11::arg("bounded") = s.bounded);
}

}  // namespace winnow::python
