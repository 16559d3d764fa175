#pragma once

#include "pipeline/python/arrays.h"
#include "pipeline/python/choices.h"

#include <winnow/pipeline/impacts.h>

namespace winnow::python {

inline constexpr Choices<FeaturePair, 2> kFeaturePairs{
    {{"vertex_face", FeaturePair::vertex_face}, {"edge_edge", FeaturePair::edge_edge}}};

/// Adds time_of_impact and feature_impacts.
void add_impacts(py::module_& module);

}  // namespace winnow::python
