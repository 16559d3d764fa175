// The class Shapes: convex shapes, and calls that apply to all shapes.

#include "pipeline/python/shared_shapes.h"

#include "pipeline/python/batch.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/refusal.h"
#include "pipeline/python/snapshots.h"

#include <winnow/pipeline/shape_rays.h>

#include <limits>
#include <vector>

namespace winnow::python {

void SharedShapes::use(std::span<const ShapeId> shapes, int change) {
  const std::lock_guard lock(uses_mutex_);
  for (const ShapeId id : shapes) uses_[id.bits] += static_cast<std::uint32_t>(change);
}

void SharedShapes::use(const ShapeUses& shapes, int change) {
  const std::lock_guard lock(uses_mutex_);
  for (const auto& [bits, count] : shapes) {
    uses_[bits] += count * static_cast<std::uint32_t>(change);
  }
}

void HeldShapes::use(std::span<const ShapeId> ids, int change) {
  for (const ShapeId id : ids) uses_[id.bits] += static_cast<std::uint32_t>(change);
  shapes_->use(ids, change);
}

void HeldShapes::clear() {
  shapes_->use(uses_, -1);
  uses_.clear();
}

namespace {

/// Returns the uses of shapes by compounds.
[[nodiscard]] ShapeUses uses_of(const CompositePool& composites) {
  ShapeUses uses;
  std::size_t left = composites.size(CompositeKind::compound);
  for (std::uint32_t index = 0; left != 0; ++index) {
    const ShapeId id = ShapeId::of(CompositeKind::compound, index);
    if (!composites.contains(id)) continue;
    --left;
    for (const CompoundChild& child : composites.children(id)) ++uses[child.shape.bits];
  }
  return uses;
}

}  // namespace

Status SharedShapes::load(std::span<const std::byte> convex, std::span<const std::byte> composite) {
  if (pins_ != 0) return Status::invalid_key;
  const std::lock_guard lock(uses_mutex_);
  ShapeUses by_compounds = uses_of(composites);
  for (const auto& [bits, count] : uses_) {
    if (count != by_compounds[bits]) return Status::invalid_key;
  }
  // Both are read into separate pools first: if one is invalid, neither pool has changed.
  ShapePool read;
  CompositePool made(read);
  Status status = read.load(convex);
  if (status == Status::ok) status = made.load(composite);
  if (status == Status::ok) status = pool.load(convex);
  if (status == Status::ok) status = composites.load(composite);
  if (status == Status::ok) uses_ = uses_of(composites);
  return status;
}

bool SharedShapes::is_used(ShapeId id) const {
  if (pins_ != 0) return true;
  const std::lock_guard lock(uses_mutex_);
  const auto found = uses_.find(id.bits);
  return found != uses_.end() && found->second != 0;
}

ShapeInput::ShapeInput(const SharedShapes& shapes, py::handle object, const char* name)
    : Integers(object, name), shapes_(shapes) {
  // Calls that add shapes return arrays, also of one id.
  if (count() == 1) set(1, true);
}

std::string ShapeInput::fault(Status status) const {
  for (std::size_t i = 0; status == Status::invalid_key && i < count(); ++i) {
    const bool exists = reading(shapes_.mutex, [&] { return shapes_.contains((*this)[i]); });
    if (!exists) return place(i) + " is of no shape: " + std::to_string((*this)[i].bits);
  }
  return {};
}

namespace {

using Shapes = SharedShapes;

// --- convex shapes -----------------------------------------------------------------------------

/// Adds `count` shapes, all or none; make(i) returns the i-th.
template <typename Make>
[[nodiscard]] py::array add_all(Shapes& shapes, std::size_t count, const char* call, Make&& make) {
  auto ids = fresh<std::uint32_t>(count);
  auto* const to = reinterpret_cast<ShapeId*>(ids.mutable_data());
  change_or_throw(shapes.mutex, call, [&] {
    for (std::size_t i = 0; i < count; ++i) {
      const Status status = shapes.pool.add(make(i)).get(to[i]);
      if (status == Status::ok) continue;
      for (std::size_t k = i; k > 0; --k) static_cast<void>(shapes.pool.remove(to[k - 1]));
      return Outcome{status, i};
    }
    return Outcome{};
  });
  return ids;
}

[[nodiscard]] py::array add_spheres(Shapes& shapes, py::handle radii) {
  Numbers radius(radii, "radius", {}, Valid::length);
  return add_all(shapes, agree({&radius}), "add_spheres",
                 [&](std::size_t i) { return SphereShape{radius.at(i)}; });
}

[[nodiscard]] py::array add_capsules(Shapes& shapes, py::handle radii, py::handle halves) {
  Numbers radius(radii, "radius", {}, Valid::length);
  Numbers half(halves, "half_length", {}, Valid::length);
  return add_all(shapes, agree({&radius, &half}), "add_capsules", [&](std::size_t i) {
    return CapsuleShape{radius.at(i), half.at(i)};
  });
}

[[nodiscard]] py::array add_boxes(Shapes& shapes, py::handle halves, py::handle roundings) {
  Numbers half(halves, "half", {3}, Valid::length);
  Numbers rounding(roundings, "rounding", {}, Valid::length);
  return add_all(shapes, agree({&half, &rounding}), "add_boxes", [&](std::size_t i) {
    return BoxShape{half.vector(i), rounding.at(i)};
  });
}

/// Adds cylinders or cones, which have the same parameters.
template <typename Shape>
[[nodiscard]] py::array add_turned(Shapes& shapes, py::handle radii, py::handle halves,
                                   py::handle roundings) {
  Numbers radius(radii, "radius", {}, Valid::length);
  Numbers half(halves, "half_length", {}, Valid::length);
  Numbers rounding(roundings, "rounding", {}, Valid::length);
  return add_all(shapes, agree({&radius, &half, &rounding}), "shapes", [&](std::size_t i) {
    return Shape{radius.at(i), half.at(i), rounding.at(i)};
  });
}

[[nodiscard]] py::array add_triangles(Shapes& shapes, py::handle corners, py::handle roundings) {
  Numbers vertex(corners, "vertices", {3, 3}, Valid::finite);
  Numbers rounding(roundings, "rounding", {}, Valid::length);
  return add_all(shapes, agree({&vertex, &rounding}), "add_triangles", [&](std::size_t i) {
    TriangleShape shape;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) shape.vertex[j][k] = vertex.at(i, j, k);
    }
    shape.rounding = rounding.at(i);
    return shape;
  });
}

[[nodiscard]] py::array add_half_spaces(Shapes& shapes, py::handle normals, py::handle offsets) {
  Numbers normal(normals, "normal", {3}, Valid::direction);
  Numbers offset(offsets, "offset", {}, Valid::finite);
  return add_all(shapes, agree({&normal, &offset}), "add_half_spaces", [&](std::size_t i) {
    return HalfSpaceShape{normal.vector(i), offset.at(i)};
  });
}

[[nodiscard]] py::array add_ellipsoids(Shapes& shapes, py::handle radii, py::handle roundings) {
  Numbers radius(radii, "radius", {3}, Valid::length);
  Numbers rounding(roundings, "rounding", {}, Valid::length);
  return add_all(shapes, agree({&radius, &rounding}), "add_ellipsoids", [&](std::size_t i) {
    return EllipsoidShape{radius.vector(i), rounding.at(i)};
  });
}

[[nodiscard]] py::array add_tapered_capsules(Shapes& shapes, py::handle radii, py::handle halves) {
  Numbers radius(radii, "radius", {2}, Valid::length);
  Numbers half(halves, "half_length", {}, Valid::length);
  return add_all(shapes, agree({&radius, &half}), "add_tapered_capsules", [&](std::size_t i) {
    return TaperedCapsuleShape{{radius.at(i, 0), radius.at(i, 1)}, half.at(i)};
  });
}

[[nodiscard]] std::uint32_t add_hull(Shapes& shapes, py::handle point_array, double rounding,
                                     py::handle indices, py::handle sizes) {
  const Numbers numbers(point_array, "points", {3}, Valid::finite);
  std::vector<Vec3d> points(numbers.count());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = numbers.vector(i);
  ShapeId id;
  if (indices.is_none() != sizes.is_none()) {
    throw Refusal(Status::invalid_argument, "add_hull: indices and sizes belong together");
  }
  if (indices.is_none()) {
    change_or_throw(shapes.mutex, "add_hull",
                    [&] { return shapes.pool.add_hull(points, rounding).get(id); });
    return id.bits;
  }
  const Integers<std::uint32_t> index(indices, "indices");
  const Integers<std::uint32_t> size(sizes, "sizes");
  const HullFaces faces{index.values(), size.values()};
  change_or_throw(shapes.mutex, "add_hull",
                  [&] { return shapes.pool.add_hull(points, faces, rounding).get(id); });
  return id.bits;
}

// --- all shapes --------------------------------------------------------------------------------

[[nodiscard]] Status remove_one(Shapes& shapes, ShapeId id) {
  if (!id.is_composite()) return shapes.pool.remove(id);
  std::vector<ShapeId> children;
  if (id.composite_kind() == CompositeKind::compound) {
    for (const CompoundChild& child : shapes.composites.children(id)) {
      children.push_back(child.shape);
    }
  }
  const Status status = shapes.composites.remove(id);
  if (status == Status::ok) shapes.use(children, -1);
  return status;
}

void remove_shapes(Shapes& shapes, py::handle id_array) {
  const ShapeInput ids(shapes, id_array);
  ++shapes.revision;
  std::vector<SupportFunctions::node_type> gone;
  change_or_throw(shapes.mutex, "remove (shapes may be in use)", [&] {
    std::vector<std::uint32_t> sorted(ids.values().begin(), ids.values().end());
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
      return Outcome{Status::invalid_key, 0};
    }
    for (std::size_t i = 0; i < ids.count(); ++i) {
      const ShapeId id = ids[i];
      if (!shapes.contains(id) || shapes.is_used(id)) return Outcome{Status::invalid_key, i};
    }
    for (std::size_t i = 0; i < ids.count(); ++i) {
      const Status status = remove_one(shapes, ids[i]);
      if (status != Status::ok) return Outcome{status, i};
      gone.push_back(shapes.supports.extract(ids[i].bits));
    }
    return Outcome{};
  });
}

[[nodiscard]] py::tuple bounds(const Shapes& shapes, py::handle id_array, py::handle poses) {
  PoseInput pose(poses);
  ShapeInput ids(shapes, id_array);
  const std::size_t count = agree({&pose, &ids});
  auto lower = fresh<float>(count, 3);
  auto upper = fresh<float>(count, 3);
  float* const low = lower.mutable_data();
  float* const high = upper.mutable_data();
  accept(reading_shapes(shapes,
                        [&] {
                          for (std::size_t i = 0; i < pose.count(); ++i) {
                            if (!shapes.contains(ids[i])) return Outcome{Status::invalid_key, i};
                            if (!pose[i].is_valid()) return Outcome{Status::invalid_pose, i};
                            const Aabb box = shapes.bounds(ids[i], pose[i]);
                            for (std::size_t axis = 0; axis < 3; ++axis) {
                              low[3 * i + axis] = box.min[axis];
                              high[3 * i + axis] = box.max[axis];
                            }
                          }
                          return Outcome{};
                        }),
         "bounds");
  return py::make_tuple(lower, upper);
}

[[nodiscard]] py::object cast_rays(const Shapes& shapes, py::handle id_array, py::handle poses,
                                   py::handle origins, py::handle directions, py::handle max_ts) {
  PoseInput pose(poses);
  ShapeInput ids(shapes, id_array);
  Numbers origin(origins, "origins", {3}, Valid::finite);
  Numbers direction(directions, "directions", {3}, Valid::direction);
  Numbers max_t(max_ts, "max_t", {});
  const std::size_t count = agree({&pose, &ids, &origin, &direction, &max_t});
  auto hit = fresh<bool>(count);
  auto t = fresh<double>(count);
  auto normal = fresh<double>(count, 3);
  bool* const to_hit = hit.mutable_data();
  double* const to_t = t.mutable_data();
  double* const to_normal = normal.mutable_data();
  accept(reading_shapes(
             shapes,
             [&] {
               return answer_all(Execution::parallel(), count, [&](std::size_t, std::size_t i) {
                 ShapeRay ray;
                 for (std::size_t k = 0; k < 3; ++k) {
                   ray.origin[k] = origin.at(i, k);
                   ray.direction[k] = direction.at(i, k);
                 }
                 ray.max_t = max_t.at(i);
                 ShapeHit found;
                 if (!shapes.pool.contains(ids[i])) return Status::invalid_key;
                 const Status status =
                     cast_ray(shapes.pool.tables(), ids[i], pose[i], ray).get(found);
                 to_hit[i] = found.hit;
                 to_t[i] = found.hit ? found.t : std::numeric_limits<double>::infinity();
                 for (std::size_t k = 0; k < 3; ++k) to_normal[3 * i + k] = found.normal[k];
                 return status;
               });
             }),
         "cast_rays");
  return table("RayHits", hit, t, normal);
}

}  // namespace

void add_shapes(py::module_& module) {
  ShapesClass type(module, "Shapes");
  type.def(py::init([] { return std::make_shared<Shapes>(); }))
      .def("add_spheres", &add_spheres)
      .def("add_capsules", &add_capsules)
      .def("add_boxes", &add_boxes)
      .def("add_cylinders", &add_turned<CylinderShape>)
      .def("add_cones", &add_turned<ConeShape>)
      .def("add_triangles", &add_triangles)
      .def("add_half_spaces", &add_half_spaces)
      .def("add_ellipsoids", &add_ellipsoids)
      .def("add_tapered_capsules", &add_tapered_capsules)
      .def("add_hull", &add_hull);
  add_support(type);
  add_composites(type);
  type.def("remove", &remove_shapes)
      .def("contains",
           [](const Shapes& shapes, py::handle id_array) {
             const ShapeInput ids(shapes, id_array);
             return each_answer<bool>(shapes.mutex, ids.count(),
                                      [&](std::size_t i) { return shapes.contains(ids[i]); });
           })
      .def("bounds", &bounds)
      .def("cast_rays", &cast_rays)
      .def("footprint", [](const Shapes& shapes) {
        const Footprint sum[2] = {shapes.pool.footprint(), shapes.composites.footprint()};
        const Bytes convex = sum[0].total();
        const Bytes composite = sum[1].total();
        return py::dict(py::arg("convex") = py::make_tuple(convex.used, convex.reserved),
                        py::arg("composite") = py::make_tuple(composite.used, composite.reserved));
      });
  add_shape_snapshots(type);
}

}  // namespace winnow::python
