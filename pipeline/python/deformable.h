#pragma once

#include "pipeline/python/arrays.h"

namespace winnow::python {

/// Meshes whose vertices move in every step.
void add_deformable(py::module_& module);

}  // namespace winnow::python
