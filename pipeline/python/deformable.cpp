// The class DeformableMesh: meshes whose vertices move in every step; candidates, impacts and
// proximity of their features.

#include "pipeline/python/deformable.h"

#include "pipeline/python/entry_columns.h"
#include "pipeline/python/impacts.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/motions.h"
#include "pipeline/python/shared_shapes.h"

#include <winnow/pipeline/deformable_mesh.h>

#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

/// A mesh, and copies of its vertex positions. The mesh reads the positions in later calls, when
/// the caller may have overwritten its arrays.
struct SharedDeformable : NeedsInit {
  explicit SharedDeformable(const DeformableMeshOptions& options) : mesh(options) {}

  using Places = std::vector<Vec3d>;
  mutable std::shared_mutex mutex;
  DeformableMesh mesh;
  /// Positions that the mesh reads, and buffers for the next step.
  Places start;
  Places end;
  Places next_start;
  Places next_end;
};

void copy_places(const Numbers& numbers, SharedDeformable::Places& places) {
  places.resize(numbers.count());
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = {numbers.at(i, 0), numbers.at(i, 1), numbers.at(i, 2)};
  }
}

[[nodiscard]] std::shared_ptr<SharedDeformable> make(const std::array<double, 3>& origin,
                                                     bool parallel) {
  DeformableMeshOptions options;
  options.origin = {origin[0], origin[1], origin[2]};
  options.execution = parallel ? Execution::parallel() : Execution::serial();
  return std::make_shared<SharedDeformable>(options);
}

void build(SharedDeformable& s, py::handle rest, py::handle triangle_array) {
  const Numbers vertices(rest, "rest", {3});
  const Integers<std::uint32_t> triangles(triangle_array, "triangles", 3);
  accept(changing(s.mutex,
                  [&] {
                    copy_places(vertices, s.next_start);
                    const Status status = s.mesh.build(s.next_start, IndexView(triangles.values()));
                    if (status == Status::ok) std::swap(s.start, s.next_start);
                    return status;
                  }),
         "build");
}

void move(SharedDeformable& s, py::handle starts, py::handle ends, double distance) {
  const Numbers start(starts, "start", {3});
  const Numbers end(ends, "end", {3});
  accept(changing(s.mutex,
                  [&] {
                    copy_places(start, s.next_start);
                    copy_places(end, s.next_end);
                    const Status status = s.mesh.move(s.next_start, s.next_end, distance);
                    if (status != Status::ok) return status;
                    std::swap(s.start, s.next_start);
                    std::swap(s.end, s.next_end);
                    return status;
                  }),
         "move");
}

[[nodiscard]] py::array edges(const SharedDeformable& s) {
  std::vector<std::uint32_t> ends;
  reading(s.mutex, [&] {
    ends.resize(2 * s.mesh.edges());
    for (std::size_t i = 0; i < ends.size() / 2; ++i) {
      const std::array<std::uint32_t, 2> edge = s.mesh.edge(i);
      ends[2 * i] = edge[0];
      ends[2 * i + 1] = edge[1];
    }
  });
  return given(std::move(ends), 2);
}

// --- queries -----------------------------------------------------------------------------------

/// Collects all chunks that query(take) passes to `take`, which never throws: its caller must not
/// be unwound. Returns `out_of_memory` if memory is refused.
template <typename Result, typename Query>
[[nodiscard]] Status gather(std::vector<Result>& all, Query&& query) {
  bool has_room = true;
  const auto take = [&](std::span<const Result> chunk) {
    try {
      if (has_room) all.insert(all.end(), chunk.begin(), chunk.end());
    } catch (const std::bad_alloc&) {
      has_room = false;
    }
  };
  const Status status = query(take);
  return status == Status::ok && !has_room ? Status::out_of_memory : status;
}

/// Returns results for one mesh.
template <typename Result, typename Query>
[[nodiscard]] std::vector<Result> found(const SharedDeformable& s, const char* call,
                                        Query&& query) {
  std::vector<Result> all;
  accept(reading(s.mutex, [&] { return gather(all, query); }), call);
  return all;
}

/// Returns results for two meshes.
template <typename Result, typename Query>
[[nodiscard]] std::vector<Result> found_of_two(const SharedDeformable& s,
                                               const SharedDeformable& other, const char* call,
                                               Query&& query) {
  std::vector<Result> all;
  accept(reading_two(s.mutex, other.mutex, [&] { return gather(all, query); }), call);
  return all;
}

[[nodiscard]] FeaturePair kind_of(const std::string& name) {
  return chosen(kFeaturePairs, name, "kind");
}

[[nodiscard]] py::array shown_candidates(std::vector<Pair>&& pairs) {
  return columns_of(std::move(pairs)).rows<std::uint32_t>(0, 2);
}

[[nodiscard]] py::array self_candidates(const SharedDeformable& s, const std::string& kind) {
  const FeaturePair features = kind_of(kind);
  return shown_candidates(found<Pair>(
      s, "self_candidates", [&](auto& take) { return s.mesh.self_candidates(features, take); }));
}

[[nodiscard]] py::array candidates_with(const SharedDeformable& s, const SharedDeformable& other,
                                        const std::string& kind) {
  const FeaturePair features = kind_of(kind);
  return shown_candidates(found_of_two<Pair>(s, other, "candidates_with", [&](auto& take) {
    return s.mesh.candidates_with(other.mesh, features, take);
  }));
}

struct MeshImpactTable : EmptyIfZero {
  py::array features;
  py::array time;
};

[[nodiscard]] MeshImpactTable shown_impacts(std::vector<MeshImpact>&& impacts) {
  const auto columns = columns_of(std::move(impacts));
  return {{},
          columns.rows<std::uint32_t>(offsetof(MeshImpact, features), 2),
          columns.column<double>(offsetof(MeshImpact, time))};
}

[[nodiscard]] MeshImpactTable self_impacts(const SharedDeformable& s, const std::string& kind,
                                           double min_separation, double tolerance,
                                           std::uint32_t max_intervals) {
  const FeaturePair features = kind_of(kind);
  const FeatureImpactOptions options{min_separation, tolerance, max_intervals};
  return shown_impacts(found<MeshImpact>(
      s, "self_impacts", [&](auto& take) { return s.mesh.self_impacts(features, options, take); }));
}

[[nodiscard]] MeshImpactTable impacts_with(const SharedDeformable& s, const SharedDeformable& other,
                                           const std::string& kind, double min_separation,
                                           double tolerance, std::uint32_t max_intervals) {
  const FeaturePair features = kind_of(kind);
  const FeatureImpactOptions options{min_separation, tolerance, max_intervals};
  return shown_impacts(found_of_two<MeshImpact>(s, other, "impacts_with", [&](auto& take) {
    return s.mesh.impacts_with(other.mesh, features, options, take);
  }));
}

struct MeshProximityTable : EmptyIfZero {
  py::array features;
  py::array distance;
  py::array point_a;
  py::array point_b;
  py::array weight;
};

[[nodiscard]] MeshProximityTable shown_near(std::vector<MeshProximity>&& near) {
  const auto columns = columns_of(std::move(near));
  constexpr std::size_t points = offsetof(MeshProximity, point);
  return {{},
          columns.rows<std::uint32_t>(offsetof(MeshProximity, features), 2),
          columns.column<double>(offsetof(MeshProximity, distance)),
          columns.rows<double>(points, 3),
          columns.rows<double>(points + sizeof(Vec3d), 3),
          columns.rows<double>(offsetof(MeshProximity, weight), 4)};
}

[[nodiscard]] MeshProximityTable self_proximity(const SharedDeformable& s, const std::string& kind,
                                                double thickness) {
  const FeaturePair features = kind_of(kind);
  return shown_near(found<MeshProximity>(s, "self_proximity", [&](auto& take) {
    return s.mesh.self_proximity(features, thickness, take);
  }));
}

[[nodiscard]] MeshProximityTable proximity_with(const SharedDeformable& s,
                                                const SharedDeformable& other,
                                                const std::string& kind, double thickness) {
  const FeaturePair features = kind_of(kind);
  return shown_near(found_of_two<MeshProximity>(s, other, "proximity_with", [&](auto& take) {
    return s.mesh.proximity_with(other.mesh, features, thickness, take);
  }));
}

struct MeshShapeImpactTable : EmptyIfZero {
  py::array face;
  py::array part;
  py::array time;
  py::array gap;
  py::array error_bound;
  py::array normal;
  py::array point;
};

[[nodiscard]] MeshShapeImpactTable impacts_with_shape(const SharedDeformable& s,
                                                      const SharedShapes& shapes,
                                                      std::uint32_t shape, py::handle motions,
                                                      double separation, double tolerance) {
  const RigidMotionInput motion(motions);
  if (motion.count() != 1) {
    throw Refusal(Status::size_mismatch, "impacts_with_shape: expected one motion, (1, 13)");
  }
  const MeshObstacle obstacle{shapes.pool, ShapeId{shape}, motion[0], separation};
  const ImpactOptions options{tolerance, Execution::serial(), &shapes.composites};
  const auto columns = columns_of(shapes.raised.during([&] {
    return found<MeshShapeImpact>(s, "impacts_with_shape", [&](auto& take) {
      const std::shared_lock lock(shapes.mutex);
      return s.mesh.impacts_with(obstacle, options, take);
    });
  }));
  using Impact = MeshShapeImpact;
  return {{},
          columns.column<std::uint32_t>(offsetof(Impact, face)),
          columns.column<std::uint32_t>(offsetof(Impact, part)),
          columns.column<double>(offsetof(Impact, time)),
          columns.column<double>(offsetof(Impact, gap)),
          columns.column<double>(offsetof(Impact, error_bound)),
          columns.rows<double>(offsetof(Impact, normal), 3),
          columns.rows<double>(offsetof(Impact, point), 3)};
}

// --- the module --------------------------------------------------------------------------------

void add_answers(py::module_& module) {
  py::class_<MeshImpactTable>(module, "MeshImpacts", "Features of meshes that touch in a step.")
      .def_readonly("features", &MeshImpactTable::features,
                    "A vertex and a face, or two edges, by number: (m, 2) uint32.")
      .def_readonly("time", &MeshImpactTable::time,
                    "Time of the first touch, in [0, 1], never late: (m,) float64.");
  using Near = MeshProximityTable;
  py::class_<Near>(module, "MeshProximities",
                   "Features of meshes that are near each other at the end of a step.")
      .def_readonly("features", &Near::features,
                    "A vertex and a face, or two edges, by number: (m, 2) uint32.")
      .def_readonly("distance", &Near::distance,
                    "Distance in the units of the vertices, (m,) float64.")
      .def_readonly("point_a", &Near::point_a, "Closest point on the first mesh: (m, 3) float64.")
      .def_readonly("point_b", &Near::point_b, "Closest point on the second mesh: (m, 3) float64.")
      .def_readonly(
          "weight", &Near::weight,
          "Barycentric weights of the points, (m, 4) float64: weight[0] of the vertex, or "
          "weight[0] and weight[1] of the ends of the first edge; the others are of the corners or "
          "ends of the second feature. The weights of a feature add up to 1.");
  using Impact = MeshShapeImpactTable;
  py::class_<Impact>(module, "MeshShapeImpacts", "Faces that touch a rigid shape in a step.")
      .def_readonly("face", &Impact::face, "Number of the face, (m,) uint32.")
      .def_readonly("part", &Impact::part,
                    "Triangle or child of the shape, WHOLE_SHAPE for a convex shape: (m,) uint32.")
      .def_readonly("time", &Impact::time, "Time in [0, 1], never late: (m,) float64.")
      .def_readonly("gap", &Impact::gap, "Gap at that time, beyond the separation: (m,) float64.")
      .def_readonly("error_bound", &Impact::error_bound, "Error bound of the gap, (m,) float64.")
      .def_readonly("normal", &Impact::normal,
                    "Unit vector from the shape to the face, at that time: (m, 3) float64.")
      .def_readonly("point", &Impact::point,
                    "Point on the shape at that time, in the world: (m, 3) float64.");
}

using MeshClass = py::class_<SharedDeformable, std::shared_ptr<SharedDeformable>>;

void add_itself(MeshClass& type) {
  using py::arg;
  type.def(py::init(&make), py::kw_only(), arg("origin") = std::array<double, 3>{0.0, 0.0, 0.0},
           arg("parallel") = true,
           "An empty mesh. Boxes are measured from `origin`: a point near the mesh keeps them "
           "tight far from (0, 0, 0). Two meshes that are tested against each other must have the "
           "same origin, else invalid_argument. An origin that is not finite makes `build` fail: "
           "invalid_bounds. `parallel` uses all cores.")
      .def("build", &build, arg("rest"), arg("triangles"),
           "Sets triangles (m, 3) and sorts them by the rest positions of vertices, (n, 3). Call "
           "`move` before any query. O(m log m).")
      .def("move", &move, arg("start"), arg("end"), arg("distance") = 0.0,
           "Sets the motion of a step: vertices move from `start` to `end`, (n, 3) each, which are "
           "copied. Features that come within `distance` (a length) are candidates. O(n).")
      .def_property_readonly(
          "triangles",
          [](const SharedDeformable& s) {
            return reading(s.mutex, [&] { return s.mesh.triangles(); });
          },
          "Number of triangles; 0 before `build`.")
      .def_property_readonly(
          "vertices",
          [](const SharedDeformable& s) {
            return reading(s.mutex, [&] { return s.mesh.vertices(); });
          },
          "Number of vertices; 0 before `build`.")
      .def("edges", &edges, "Vertices of all edges, the lower one first: (e, 2) uint32, sorted.")
      .def(
          "footprint",
          [](const SharedDeformable& s) {
            const Bytes bytes = reading(s.mutex, [&] { return s.mesh.footprint().total(); });
            return py::make_tuple(bytes.used, bytes.reserved);
          },
          "Bytes (used, reserved), without the positions of vertices.");
}

void add_mesh_queries(MeshClass& type) {
  using py::arg;
  const FeatureImpactOptions defaults;
  type.def("self_candidates", &self_candidates, arg("kind"),
           "Pairs of features whose boxes overlap, (m, 2) uint32. `kind`: 'vertex_face', a vertex "
           "and a face, or 'edge_edge', two edges, the lower one first. Features that share a "
           "vertex are left out.")
      .def("candidates_with", &candidates_with, arg("other"), arg("kind"),
           "Pairs of features of this mesh (first) and of another one, as self_candidates.")
      .def("self_impacts", &self_impacts, arg("kind"), py::kw_only(),
           arg("min_separation") = defaults.min_separation, arg("tolerance") = defaults.tolerance,
           arg("max_intervals") = defaults.max_intervals,
           "Features that touch in the step, with times: MeshImpacts. Options as in "
           "`feature_impacts`; `min_separation` is at most the distance of the step.")
      .def(
          "impacts_with", &impacts_with, arg("other"), arg("kind"), py::kw_only(),
          arg("min_separation") = defaults.min_separation, arg("tolerance") = defaults.tolerance,
          arg("max_intervals") = defaults.max_intervals,
          "As self_impacts, with another mesh; `min_separation` is at most half of both distances.")
      .def("impacts_with_shape", &impacts_with_shape, arg("shapes"), arg("shape"), arg("motion"),
           py::kw_only(), arg("separation") = 0.0, arg("tolerance") = 1e-6,
           "Faces that touch a shape of `shapes` that moves by `motion`, (1, 13) as returned by "
           "`motions_between`, with times: MeshShapeImpacts. `separation` (a length) is at most "
           "half of the distance of the step; `tolerance` as in `time_of_impact`.")
      .def("self_proximity", &self_proximity, arg("kind"), arg("thickness"),
           "Features with a distance of at most `thickness` at the end of the step: "
           "MeshProximities. `thickness` is at most the distance of the step.")
      .def("proximity_with", &proximity_with, arg("other"), arg("kind"), arg("thickness"),
           "As self_proximity, with another mesh; `thickness` is at most half of both distances.");
}

}  // namespace

void add_deformable(py::module_& module) {
  add_answers(module);
  MeshClass type(
      module, "DeformableMesh",
      "A mesh whose vertices move in every step, for cloth and soft bodies. Finds vertices and "
      "faces, or edges, that may touch, do touch or are near each other, in one mesh or between "
      "two. Any number of threads may call it; a call that raises changes nothing.");
  add_itself(type);
  add_mesh_queries(type);
}

}  // namespace winnow::python
