#pragma once

#include <pybind11/pybind11.h>

namespace winnow::python {

/// What profilers and logs are told.
void add_hooks(pybind11::module_& module);

}  // namespace winnow::python
