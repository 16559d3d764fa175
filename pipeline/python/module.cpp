// The module `_core`: converts Status to exceptions, defines constants, and adds the contents of
// the other files.

#include <pybind11/pybind11.h>

#include "pipeline/python/cluster.h"
#include "pipeline/python/deformable.h"
#include "pipeline/python/drawing.h"
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
  if (status != Status::ok) throw Refusal(status, what + ": " + meaning(status));
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
  members["status"] = "";
  status_error = PyErr_NewExceptionWithDoc(
      "winnow.StatusError",
      "A call failed and has changed nothing. `status` is the reason: invalid_bounds, invalid_key, "
      "invalid_argument, size_mismatch, too_many_objects, unsupported_volume, invalid_shape, "
      "invalid_pose or unsupported. out_of_memory raises a MemoryError.",
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
  const Numbers low(lower, "lower", {3});
  Numbers high(upper, "upper", {3});
  high.expect(low.count());
  Numbers from(origin, "origin", {3}, true);
  from.expect(low.count());
  auto down = fresh<float>(low.count(), 3);
  auto up = fresh<float>(low.count(), 3);
  float* to[2] = {down.mutable_data(), up.mutable_data()};
  const auto place = [](const Numbers& numbers, std::size_t i) {
    return Vec3d(numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2));
  };
  for (std::size_t i = 0; i < low.count(); ++i) {
    const Aabb box = Aabb::outward(place(low, i), place(high, i), place(from, i));
    for (int axis = 0; axis < 3; ++axis) {
      *to[0]++ = box.min[axis];
      *to[1]++ = box.max[axis];
    }
  }
  return py::make_tuple(down, up);
}

void add_instruction_sets(py::module_& module) {
  module.def(
      "isa_name", [] { return std::string(isa_name()); },
      "The instruction set in use: sse42, avx2, avx512 or neon64.");
  module.def(
      "available_isas",
      [] {
        std::vector<std::string> names;
        for (const Isa isa : available_isas()) names.emplace_back(to_string(isa));
        return names;
      },
      "Instruction sets of this build that the machine supports, narrowest first.");
  module.def(
      "set_isa",
      [](const std::string& name) { accept(set_isa(std::string_view(name)), "set_isa"); },
      py::arg("name"), "Chooses an instruction set for the whole process.");
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ part of winnow; use the package `winnow`.";
  module.attr("__version__") = WINNOW_PROJECT_VERSION;
  add_errors(module);
  module.attr("NULL_KEY") = ~std::uint64_t{0} >> 32U;
  module.attr("NO_OBJECT") = kNoObject;
  module.attr("WHOLE_SHAPE") = kWholeShape;
  module.attr("EVERY_ENVIRONMENT") = kAllEnvironments;
  module.def("outward", &outward, py::arg("lower"), py::arg("upper"), py::arg("origin"),
             "The smallest float boxes, (n, 3) float32 each, that contain boxes in double, "
             "measured from `origin`, (n, 3) or (3,): for worlds far from 0.");
  add_instruction_sets(module);
  add_drawing(module);
  add_recordings(module);
  PartitionClass partition(
      module, "Partition",
      "Stores boxes, returns keys, and finds pairs that may touch; it never misses a pair. Any "
      "number of threads may call it. A call that raises changes nothing. Other threads must not "
      "write to arrays while a call reads them.");
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
