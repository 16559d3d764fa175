// The module `_core`: converts Status to exceptions, defines constants, and adds the contents of
// the other files.

#include <pybind11/pybind11.h>

#include "pipeline/python/cluster.h"
#include "pipeline/python/deformable.h"
#include "pipeline/python/filters.h"
#include "pipeline/python/hooks.h"
#include "pipeline/python/impacts.h"
#include "pipeline/python/motions.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/recordings.h"
#include "pipeline/python/refusal.h"
#include "pipeline/python/shared_shapes.h"
#include "pipeline/python/snapshots.h"

#include <winnow/core/volumes.h>
#include <winnow/simd/isa.h>

namespace winnow::python {

const char* meaning(Status status) noexcept {
  switch (status) {
    case Status::ok:
      return "done";
    case Status::invalid_bounds:
      return "a bound is NaN, lower is above upper, or it lies wholly at infinity";
    case Status::invalid_key:
      return "a key is null, stale or from elsewhere, or it is there twice";
    case Status::invalid_argument:
      return "an argument is outside its range";
    case Status::size_mismatch:
      return "arrays that belong together differ in length";
    case Status::out_of_memory:
      return "there is not enough memory";
    case Status::too_many_objects:
      return "there are more objects than ids";
    case Status::unsupported_volume:
      return "the partition does not hold this kind of volume";
    case Status::invalid_shape:
      return "a length is negative or not finite, or no shape can be made of the points";
    case Status::invalid_pose:
      return "a pose is not finite, or its quaternion is zero";
    case Status::unsupported:
      return "this cannot be asked, or the library was built without it";
    case Status::communication_failed:
      return "a rank of a cluster does not answer";
  }
  return "";
}

void accept(Status status, const std::string& what) {
  if (status == Status::ok) return;
  const std::string fault = Input::first_fault(status);
  throw Refusal(status, fault.empty() ? what + ": " + meaning(status) : fault);
}

namespace {

// Never released: exceptions may be thrown until the process ends.
PyObject* status_error = nullptr;

void raise(const Refusal& refusal) {
  if (refusal.status() == Status::out_of_memory) {
    PyErr_SetString(PyExc_MemoryError, refusal.what());
    return;
  }
  const auto type = py::reinterpret_borrow<py::object>(status_error);
  const py::object error = type(refusal.what());
  error.attr("status") = to_string(refusal.status());
  PyErr_SetObject(type.ptr(), error.ptr());
}

void add_errors(py::module_& module) {
  py::dict members;
  members["status"] = to_string(Status::ok);
  status_error = PyErr_NewExceptionWithDoc("winnow.StatusError", described({}, "StatusError").text,
                                           PyExc_ValueError, members.ptr());
  if (status_error == nullptr) throw py::error_already_set();
  module.add_object("StatusError", py::reinterpret_borrow<py::object>(status_error));
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Refusal& refusal) {
      raise(refusal);
    }
  });
}

[[nodiscard]] py::tuple outward(py::handle lower, py::handle upper, py::handle origin) {
  Numbers low(lower, "lower", {3});
  Numbers high(upper, "upper", {3});
  Numbers from(origin, "origin", {3});
  const std::size_t count = agree({&low, &high, &from});
  auto down = fresh<float>(count, 3);
  auto up = fresh<float>(count, 3);
  float* to[2] = {down.mutable_data(), up.mutable_data()};
  for (std::size_t i = 0; i < count; ++i) {
    const Aabb box = Aabb::outward(low.vector(i), high.vector(i), from.vector(i));
    for (int axis = 0; axis < 3; ++axis) {
      *to[0]++ = box.min[axis];
      *to[1]++ = box.max[axis];
    }
  }
  return py::make_tuple(down, up);
}

void add_instruction_sets(py::module_& module) {
  add_function(module, "isa_name", [] { return std::string(isa_name()); });
  add_function(module, "available_isas", [] {
    std::vector<std::string> names;
    for (const Isa isa : available_isas()) names.emplace_back(to_string(isa));
    return names;
  });
  add_function(module, "set_isa",
               [](const std::string& name) { accept(set_isa(std::string_view(name)), "set_isa"); });
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  py::options texts;
  texts.disable_function_signatures();  // the stubs state them
  module.doc() = "The C++ part of winnow; use the package `winnow`.";
  module.attr("__version__") = WINNOW_PROJECT_VERSION;
  add_errors(module);
  module.attr("NULL_KEY") = ~std::uint64_t{0} >> 32U;
  module.attr("NO_OBJECT") = kNoObject;
  module.attr("WHOLE_SHAPE") = kWholeShape;
  module.attr("EVERY_ENVIRONMENT") = kAllEnvironments;
  add_function(module, "outward", &outward);
  add_instruction_sets(module);
  add_recordings(module);
  PartitionClass partition(module, "Partition");
  add_filters(module);
  add_hooks(module);
  add_queries(module, partition);
  add_pairs(module, partition);
  add_partition(module, partition);
  add_objects(module, partition);
  add_partition_snapshots(partition);
  add_shapes(module);
  add_narrow(module);
  add_motions(module);
  add_impacts(module);
  add_deformable(module);
  add_scene(module);
  add_cluster(module);
  add_cluster_scene(module);
}

}  // namespace winnow::python
