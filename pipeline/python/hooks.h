#pragma once

#include <pybind11/pybind11.h>

namespace winnow::python {

/// Adds set_stage_hook and set_log_hook.
void add_hooks(pybind11::module_& module);

}  // namespace winnow::python
