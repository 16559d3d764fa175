#pragma once

#include "pipeline/python/arrays.h"

namespace winnow::python {

/// Recorders, and what plays what they wrote.
void add_recordings(py::module_& module);

}  // namespace winnow::python
