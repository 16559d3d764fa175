#pragma once

#include "pipeline/python/arrays.h"

namespace winnow::python {

/// Adds Recorder and replay.
void add_recordings(py::module_& module);

}  // namespace winnow::python
