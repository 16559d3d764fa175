#pragma once

#include <pybind11/pybind11.h>

namespace winnow::python {

void add_cluster(pybind11::module_& module);
void add_cluster_scene(pybind11::module_& module);

}  // namespace winnow::python
