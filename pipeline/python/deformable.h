#pragma once

#include "pipeline/python/arrays.h"

namespace winnow::python {

/// Adds DeformableMesh.
void add_deformable(py::module_& module);

}  // namespace winnow::python
