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
    places[i] = numbers.vector(i);
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
  const Numbers vertices(rest, "rest", {3}, Valid::finite);
  Integers<std::uint32_t> triangles(triangle_array, "triangles", 3);
  triangles.limit(vertices.count());
  change_or_throw(s.mutex, "build", [&] {
    copy_places(vertices, s.next_start);
    const Status status = s.mesh.build(s.next_start, IndexView(triangles.values()));
    if (status == Status::ok) std::swap(s.start, s.next_start);
    return status;
  });
}

void move(SharedDeformable& s, py::handle starts, py::handle ends, double distance) {
  const Numbers start(starts, "start", {3}, Valid::finite);
  const Numbers end(ends, "end", {3}, Valid::finite);
  change_or_throw(s.mutex, "move", [&] {
    copy_places(start, s.next_start);
    copy_places(end, s.next_end);
    const Status status = s.mesh.move(s.next_start, s.next_end, distance);
    if (status != Status::ok) return status;
    std::swap(s.start, s.next_start);
    std::swap(s.end, s.next_end);
    return status;
  });
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

[[nodiscard]] py::object shown_impacts(std::vector<MeshImpact>&& impacts) {
  const auto columns = columns_of(std::move(impacts));
  return columns.table("MeshImpacts", &MeshImpact::features, &MeshImpact::time);
}

[[nodiscard]] py::object self_impacts(const SharedDeformable& s, const std::string& kind,
                                      double min_separation, double tolerance,
                                      std::uint32_t max_intervals) {
  const FeaturePair features = kind_of(kind);
  const FeatureImpactOptions options{min_separation, tolerance, max_intervals};
  return shown_impacts(found<MeshImpact>(
      s, "self_impacts", [&](auto& take) { return s.mesh.self_impacts(features, options, take); }));
}

[[nodiscard]] py::object impacts_with(const SharedDeformable& s, const SharedDeformable& other,
                                      const std::string& kind, double min_separation,
                                      double tolerance, std::uint32_t max_intervals) {
  const FeaturePair features = kind_of(kind);
  const FeatureImpactOptions options{min_separation, tolerance, max_intervals};
  return shown_impacts(found_of_two<MeshImpact>(s, other, "impacts_with", [&](auto& take) {
    return s.mesh.impacts_with(other.mesh, features, options, take);
  }));
}

[[nodiscard]] py::object shown_near(std::vector<MeshProximity>&& near) {
  const auto columns = columns_of(std::move(near));
  constexpr std::size_t points = offsetof(MeshProximity, point);
  return columns.table("MeshProximities", &MeshProximity::features, &MeshProximity::distance,
                       columns.rows<double>(points, 3),
                       columns.rows<double>(points + sizeof(Vec3d), 3), &MeshProximity::weight);
}

[[nodiscard]] py::object self_proximity(const SharedDeformable& s, const std::string& kind,
                                        double thickness) {
  const FeaturePair features = kind_of(kind);
  return shown_near(found<MeshProximity>(s, "self_proximity", [&](auto& take) {
    return s.mesh.self_proximity(features, thickness, take);
  }));
}

[[nodiscard]] py::object proximity_with(const SharedDeformable& s, const SharedDeformable& other,
                                        const std::string& kind, double thickness) {
  const FeaturePair features = kind_of(kind);
  return shown_near(found_of_two<MeshProximity>(s, other, "proximity_with", [&](auto& take) {
    return s.mesh.proximity_with(other.mesh, features, thickness, take);
  }));
}

[[nodiscard]] py::object impacts_with_shape(const SharedDeformable& s, const SharedShapes& shapes,
                                            std::uint32_t shape, py::handle motions,
                                            double separation, double tolerance) {
  const RigidMotionInput motion(motions, "motion");
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
  return columns.table("MeshShapeImpacts", &Impact::face, &Impact::part, &Impact::time,
                       &Impact::gap, &Impact::error_bound, &Impact::normal, &Impact::point);
}

}  // namespace

void add_deformable(py::module_& module) {
  Class<SharedDeformable>(module, "DeformableMesh")
      .def(py::init(&make))
      .def("build", &build)
      .def("move", &move)
      .property("triangles",
                [](const SharedDeformable& s) {
                  return reading(s.mutex, [&] { return s.mesh.triangles(); });
                })
      .property("vertices",
                [](const SharedDeformable& s) {
                  return reading(s.mutex, [&] { return s.mesh.vertices(); });
                })
      .def("edges", &edges)
      .def("footprint",
           [](const SharedDeformable& s) {
             const Bytes bytes = reading(s.mutex, [&] { return s.mesh.footprint().total(); });
             return py::make_tuple(bytes.used, bytes.reserved);
           })
      .def("self_candidates", &self_candidates)
      .def("candidates_with", &candidates_with)
      .def("self_impacts", &self_impacts)
      .def("impacts_with", &impacts_with)
      .def("impacts_with_shape", &impacts_with_shape)
      .def("self_proximity", &self_proximity)
      .def("proximity_with", &proximity_with);
}

}  // namespace winnow::python
