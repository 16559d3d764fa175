// Triangle meshes, height fields and compounds of the class Shapes.

#include "pipeline/python/batch.h"
#include "pipeline/python/entry_columns.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/refusal.h"
#include "pipeline/python/shared_shapes.h"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

/// Returns a view of the points; copies nothing.
[[nodiscard]] PointView view_of(const Numbers& points) {
  const auto stride = static_cast<std::size_t>(points.stride());
  if (points.is_single()) {
    return {{points.column<float>(0), points.column<float>(1), points.column<float>(2)},
            points.count(),
            stride};
  }
  return {{points.column<double>(0), points.column<double>(1), points.column<double>(2)},
          points.count(),
          stride};
}

[[nodiscard]] std::uint32_t add_mesh(SharedShapes& shapes, py::handle vertex_array,
                                     py::handle triangle_array, double active_edge_angle) {
  const Numbers vertices(vertex_array, "vertices", {3}, Valid::finite);
  Integers<std::uint32_t> triangles(triangle_array, "triangles", 3);
  triangles.limit(vertices.count());
  ShapeId id;
  change_or_throw(shapes.mutex, "add_mesh", [&] {
    return shapes.composites
        .add_mesh(view_of(vertices), IndexView(triangles.values()), {active_edge_angle})
        .get(id);
  });
  return id.bits;
}

[[nodiscard]] std::uint32_t add_scaled(SharedShapes& shapes, std::uint32_t mesh,
                                       const std::array<double, 3>& scale) {
  ShapeId id;
  change_or_throw(shapes.mutex, "add_scaled", [&] {
    return shapes.composites.add_scaled(ShapeId{mesh}, Vec3d(scale)).get(id);
  });
  return id.bits;
}

void refit_mesh(SharedShapes& shapes, std::uint32_t mesh, py::handle vertex_array) {
  const Numbers vertices(vertex_array, "vertices", {3}, Valid::finite);
  change_or_throw(shapes.mutex, "refit_mesh", [&] {
    ++shapes.revision;
    return shapes.composites.refit_mesh(ShapeId{mesh}, view_of(vertices));
  });
}

/// Heights (rows, columns); copied unless each row is contiguous.
class HeightInput {
 public:
  HeightInput(const py::array& heights, const std::array<double, 2>& spacing)
      : heights_(numbers_of(heights)), spacing_(spacing) {
    if (heights_.ndim() != 2) {
      throw Refusal(Status::size_mismatch, "heights: expected shape (rows, columns)");
    }
    const auto most = std::numeric_limits<std::uint32_t>::max();
    for (const py::ssize_t axis : {0, 1}) {
      if (static_cast<std::uint64_t>(heights_.shape(axis)) > most) {
        throw Refusal(Status::too_many_objects, "heights");
      }
    }
  }
  [[nodiscard]] HeightSamples samples() const {
    return {{heights_.data(), static_cast<std::size_t>(heights_.size())},
            static_cast<std::uint32_t>(heights_.shape(1)),
            static_cast<std::uint32_t>(heights_.shape(0)),
            0,
            {spacing_[0], spacing_[1]}};
  }

 private:
  [[nodiscard]] static const py::array& numbers_of(const py::array& array) {
    const char kind = array.dtype().kind();
    if (kind == 'f' || kind == 'i' || kind == 'u') return array;
    throw py::type_error("heights: expected numbers");
  }

  py::array_t<float, py::array::c_style | py::array::forcecast> heights_;
  std::array<double, 2> spacing_;
};

[[nodiscard]] std::uint32_t add_height_field(SharedShapes& shapes, const py::array& heights,
                                             const std::array<double, 2>& spacing) {
  const HeightInput input(heights, spacing);
  ShapeId id;
  change_or_throw(shapes.mutex, "add_height_field",
                  [&] { return shapes.composites.add_height_field(input.samples()).get(id); });
  return id.bits;
}

void update_height_field(SharedShapes& shapes, std::uint32_t field, std::uint32_t column,
                         std::uint32_t row, const py::array& heights) {
  const HeightInput input(heights, {1.0, 1.0});
  change_or_throw(shapes.mutex, "update_height_field", [&] {
    ++shapes.revision;
    return shapes.composites.update_height_field(ShapeId{field}, column, row, input.samples());
  });
}

[[nodiscard]] std::uint32_t add_compound(SharedShapes& shapes, py::handle children,
                                         py::handle poses) {
  PoseInput pose(poses);
  ShapeInput shape(shapes, children, "children");
  std::vector<CompoundChild> list(agree({&pose, &shape}));
  const std::vector<ShapeId> used(shape.list().begin(), shape.list().end());
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = {shape[i], pose[i]};
  ShapeId id;
  change_or_throw(shapes.mutex, "add_compound", [&] {
    const Status status = shapes.composites.add_compound(list).get(id);
    if (status == Status::ok) shapes.use(used, 1);
    return status;
  });
  return id.bits;
}

[[nodiscard]] py::tuple compound_parts(const SharedShapes& shapes, std::uint32_t compound,
                                       py::handle parts) {
  const Integers<std::uint32_t> part(parts, "parts");
  auto child = fresh<std::uint32_t>(part.count());
  auto own = fresh<std::uint32_t>(part.count());
  std::uint32_t* const to_child = child.mutable_data();
  std::uint32_t* const to_own = own.mutable_data();
  read_or_throw(shapes.mutex, "compound_parts", [&] {
    for (std::size_t i = 0; i < part.count(); ++i) {
      const CompoundPart found = shapes.composites.part(ShapeId{compound}, part[i]);
      if (found.child == kWholeShape) return Outcome{Status::invalid_key, i};
      to_child[i] = found.child;
      to_own[i] = found.part;
    }
    return Outcome{};
  });
  return py::make_tuple(child, own);
}

/// Calls set(id, now) for each surface. If one call fails, gives the surfaces before it their old
/// values, which is(id) returned.
template <typename Set, typename Is>
void set_each(SharedShapes& shapes, py::handle surface_array, bool now, const char* call, Set&& set,
              Is&& is) {
  const ShapeInput surfaces(shapes, surface_array, "surfaces");
  std::vector<std::uint8_t> was(surfaces.count());
  change_or_throw(shapes.mutex, call, [&] {
    ++shapes.revision;
    for (std::size_t i = 0; i < was.size(); ++i) {
      was[i] = is(surfaces[i]) ? 1 : 0;
      const Status status = set(surfaces[i], now);
      if (status == Status::ok) continue;
      for (std::size_t k = i; k > 0; --k) {
        static_cast<void>(set(surfaces[k - 1], was[k - 1] != 0));
      }
      return Outcome{status, i};
    }
    return Outcome{};
  });
}

void set_one_sided(SharedShapes& shapes, py::handle surfaces, bool one_sided) {
  CompositePool& pool = shapes.composites;
  set_each(
      shapes, surfaces, one_sided, "set_one_sided",
      [&](ShapeId id, bool now) { return pool.set_one_sided(id, now); },
      [&](ShapeId id) { return pool.is_one_sided(id); });
}

void set_solid(SharedShapes& shapes, py::handle meshes, bool solid) {
  CompositePool& pool = shapes.composites;
  set_each(
      shapes, meshes, solid, "set_solid",
      [&](ShapeId id, bool now) { return pool.set_solid(id, now); },
      [&](ShapeId id) { return pool.is_solid(id); });
}

/// Returns answer(id) for each composite shape; invalid_key if there is no such shape.
template <typename T, typename Answer>
[[nodiscard]] py::array of_composites(const SharedShapes& shapes, py::handle id_array,
                                      const char* call, Answer&& answer) {
  const ShapeInput ids(shapes, id_array);
  auto result = fresh<T>(ids.count());
  T* const to = result.mutable_data();
  read_or_throw(shapes.mutex, call, [&] {
    for (std::size_t i = 0; i < ids.count(); ++i) {
      const ShapeId id = ids[i];
      if (!id.is_composite() || !shapes.composites.contains(id)) {
        return Outcome{Status::invalid_key, i};
      }
      to[i] = answer(id);
    }
    return Outcome{};
  });
  return result;
}

[[nodiscard]] py::tuple compound_children(const SharedShapes& shapes, std::uint32_t compound) {
  std::vector<CompoundChild> children;
  const ShapeId id{compound};
  read_or_throw(shapes.mutex, "compound_children", [&] {
    const std::span<const CompoundChild> all = shapes.composites.children(id);
    children.assign(all.begin(), all.end());
    return all.empty() ? Status::invalid_key : Status::ok;
  });
  const auto columns = columns_of(std::move(children));
  return py::make_tuple(columns.of(&CompoundChild::shape), columns.of(&CompoundChild::pose));
}

}  // namespace

void add_composites(ShapesClass& type) {
  type.def("add_mesh", &add_mesh)
      .def("add_scaled", &add_scaled)
      .def("refit_mesh", &refit_mesh)
      .def("add_height_field", &add_height_field)
      .def("update_height_field", &update_height_field)
      .def("add_compound", &add_compound)
      .def("compound_parts", &compound_parts)
      .def("compound_children", &compound_children)
      .def("parts",
           [](const SharedShapes& shapes, py::handle ids) {
             return of_composites<std::uint32_t>(
                 shapes, ids, "parts", [&](ShapeId id) { return shapes.composites.parts(id); });
           })
      .def("set_one_sided", &set_one_sided)
      .def("is_one_sided",
           [](const SharedShapes& shapes, py::handle ids) {
             return of_composites<bool>(shapes, ids, "is_one_sided", [&](ShapeId id) {
               return shapes.composites.is_one_sided(id);
             });
           })
      .def("set_solid", &set_solid)
      .def("is_solid", [](const SharedShapes& shapes, py::handle ids) {
        return of_composites<bool>(shapes, ids, "is_solid",
                                   [&](ShapeId id) { return shapes.composites.is_solid(id); });
      });
}

}  // namespace winnow::python
