// Convex user shapes, described by a Python support function.

#include "pipeline/python/shared_shapes.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace winnow::python {

void SupportCallback::evaluate(const void* context, const double direction[3], double point[3]) {
  const auto& self = *static_cast<const SupportCallback*>(context);
  self.function_.call(
      [&](const py::object& function) {
        py::array_t<double> toward(3);
        std::copy_n(direction, 3, toward.mutable_data());
        using Point = py::array_t<double, py::array::c_style | py::array::forcecast>;
        const Point answer = Point::ensure(function(toward));
        if (!answer || answer.ndim() != 1 || answer.size() != 3) {
          throw py::type_error("a support function gives a point: three numbers");
        }
        std::copy_n(answer.data(), 3, point);
      },
      [&] {
        self.raised_.keep();
        // The point on the bounding ball: boxes that are computed meanwhile are not too small.
        for (int axis = 0; axis < 3; ++axis) point[axis] = self.radius_ * direction[axis];
      });
}

namespace {

[[nodiscard]] std::uint32_t add_one(SharedShapes& shapes, const py::object& function, double radius,
                                    double rounding) {
  auto made = std::make_unique<SupportCallback>(function, radius, shapes.raised);
  const SupportShape shape = made->shape(rounding);
  ShapeId id;
  try {
    accept(shapes.raised.during([&] {
      return changing(shapes.mutex, [&] {
        const Status status = shapes.pool.add(shape).get(id);
        if (status == Status::ok) shapes.supports.emplace(id.bits, std::move(made));
        return status;
      });
    }),
           "add_support");
  } catch (const py::error_already_set&) {
    changing(shapes.mutex, [&] {
      if (shapes.pool.remove(id) == Status::ok) made = std::move(shapes.supports[id.bits]);
      shapes.supports.erase(id.bits);
    });
    throw;
  }
  return id.bits;
}

}  // namespace

void add_support(ShapesClass& type) {
  type.def("add_support", &add_one);
}

}  // namespace winnow::python
