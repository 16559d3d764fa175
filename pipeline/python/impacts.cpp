// Times of impact of moving shapes and of mesh features.

#include "pipeline/python/impacts.h"

#include "pipeline/python/locks.h"
#include "pipeline/python/motions.h"
#include "pipeline/python/shared_shapes.h"

#include <winnow/pipeline/impacts.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace winnow::python {
namespace {

/// Results for pairs of shapes. They do not change after the call.
struct Impacts : NeedsInit, std::enable_shared_from_this<Impacts> {
  ImpactResult result;
};
using HeldImpacts = std::shared_ptr<Impacts>;

/// Throws the error of the first pair that failed.
void accept_all(const ImpactResult& result) {
  const auto bad = std::find_if(result.status().begin(), result.status().end(),
                                [](Status status) { return status != Status::ok; });
  if (bad == result.status().end()) return;
  accept(*bad, "time_of_impact, pair " + std::to_string(bad - result.status().begin()));
}

[[nodiscard]] HeldImpacts shape_impacts(const SharedShapes& shapes, py::handle shape_of,
                                        py::handle motions, py::handle pair_array, double tolerance,
                                        bool parallel) {
  const RigidMotionInput motion(motions);
  const ShapeInput shape(shape_of, "shape_of");
  shape.expect(motion.count());
  const Integers<std::uint32_t> pairs(pair_array, "pairs", 2);
  static_assert(sizeof(BodyPair) == 2 * sizeof(std::uint32_t));
  const std::span<const BodyPair> list(reinterpret_cast<const BodyPair*>(pairs.values().data()),
                                       pairs.count());
  auto answers = std::make_shared<Impacts>();
  accept(reading_shapes(shapes,
                        [&] {
                          std::vector<ShapeId> ids;
                          std::vector<RigidMotion> room;
                          const ImpactOptions options{
                              tolerance, parallel ? Execution::parallel() : Execution::serial(),
                              &shapes.composites};
                          return time_of_impact(
                              shapes.pool, {shape.list(motion.count(), ids), motion.packed(room)},
                              list, options, answers->result);
                        }),
         "time_of_impact");
  accept_all(answers->result);
  return answers;
}

template <typename T>
[[nodiscard]] py::array column(const Impacts& held, std::span<const T> values) {
  return shown(held.shared_from_this(), values.data(), values.size());
}

void add_result(py::module_& module) {
  py::class_<Impacts, HeldImpacts>(
      module, "Impacts",
      "Times of impact of pairs of shapes, in the order of the pairs. Columns are read-only views "
      "that never change; vectors are new arrays.")
      .def("__len__", [](const Impacts& held) { return held.result.size(); })
      .def_property_readonly(
          "hit",
          [](const Impacts& held) {
            auto hits = fresh<bool>(held.result.size());
            std::copy(held.result.hit().begin(), held.result.hit().end(), hits.mutable_data());
            return hits;
          },
          "True if they touch: (n,) bool. False is certain.")
      .def_property_readonly(
          "time", [](const Impacts& held) { return column(held, held.result.time()); },
          "Time in [0, 1], never late: at every earlier time they are apart. 1 if they do not "
          "touch. (n,) float64.")
      .def_property_readonly(
          "gap", [](const Impacts& held) { return column(held, held.result.gap()); },
          "Distance at that time; negative if they overlap at the start, 0 if they do not touch. "
          "(n,) float64.")
      .def_property_readonly(
          "error_bound",
          [](const Impacts& held) { return column(held, held.result.error_bound()); },
          "The true distance at that time is within gap +- this. (n,) float64.")
      .def_property_readonly(
          "normal",
          [](const Impacts& held) {
            return vectors([&](int axis) { return held.result.normal(axis); });
          },
          "Unit vector from a to b at that time, in world axes: (n, 3) float64.")
      .def_property_readonly(
          "point",
          [](const Impacts& held) {
            return vectors([&](int axis) { return held.result.point(axis); });
          },
          "Point on a, relative to the position of a at that time; the point on b is gap * normal "
          "farther. (n, 3) float64.")
      .def_property_readonly(
          "part_a", [](const Impacts& held) { return column(held, held.result.part_a()); },
          "Triangle or child of a that touches b, WHOLE_SHAPE for convex shapes: (n,) uint32.")
      .def_property_readonly(
          "part_b", [](const Impacts& held) { return column(held, held.result.part_b()); },
          "Triangle or child of b, as part_a.");
}

/// Converts four points of each of n features to columns: coordinate (k, axis) of feature i is
/// numbers[(3 * k + axis) * n + i].
[[nodiscard]] std::vector<double> feature_columns(const Numbers& points) {
  const std::size_t count = points.count();
  std::vector<double> columns(12 * count);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double* const to = columns.data() + (3 * k + axis) * count;
      for (std::size_t i = 0; i < count; ++i) to[i] = points.at(i, k, axis);
    }
  }
  return columns;
}

[[nodiscard]] py::array feature_times(const std::string& kind_name, py::handle starts,
                                      py::handle ends, double min_separation, double tolerance,
                                      std::uint32_t max_intervals) {
  const FeaturePair kind = chosen(kFeaturePairs, kind_name, "kind");
  const Numbers start(starts, "start", {4, 3});
  Numbers end(ends, "end", {4, 3});
  end.expect(start.count());
  const std::size_t count = start.count();
  auto times = fresh<double>(count);
  const std::span<double> out(times.mutable_data(), count);
  const auto answer = [&] {
    const WithoutGil release;
    const std::vector<double> from = feature_columns(start);
    const std::vector<double> to = feature_columns(end);
    FeatureColumns pairs;
    pairs.count = count;
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        pairs.start[k][axis] = from.data() + (3 * k + axis) * count;
        pairs.end[k][axis] = to.data() + (3 * k + axis) * count;
      }
    }
    return feature_impacts(kind, pairs, out, {min_separation, tolerance, max_intervals});
  };
  accept(answer(), "feature_impacts");
  return times;
}

}  // namespace

void add_impacts(py::module_& module) {
  using py::arg;
  add_result(module);
  module.def(
      "time_of_impact", &shape_impacts, arg("shapes"), arg("shape_of"), arg("motions"),
      arg("pairs"), py::kw_only(), arg("tolerance") = 1e-6, arg("parallel") = true,
      "Times of impact of pairs (m, 2) uint32 of bodies. Body i has the shape shape_of[i] of "
      "`shapes`, (n,) or one for all, convex or composite, and moves by motions (n, 13), as "
      "returned by `motions_between` and `motions_by_velocities`. At the time of impact the gap is "
      "at most `tolerance`, in (0, 1], of the smaller shape's size. One bad pair makes the call "
      "fail: size_mismatch, invalid_key for an unknown shape, invalid_pose for an invalid motion, "
      "invalid_argument for an unknown body or a bad tolerance. A pair takes about three "
      "closest-point computations, up to |turn| / sqrt(tolerance) if shapes rotate fast around "
      "each other; composite shapes take as many for each pair of parts whose boxes overlap.");
  const FeatureImpactOptions defaults;
  module.def(
      "feature_impacts", &feature_times, arg("kind"), arg("start"), arg("end"), py::kw_only(),
      arg("min_separation") = defaults.min_separation, arg("tolerance") = defaults.tolerance,
      arg("max_intervals") = defaults.max_intervals,
      "Times at which mesh features first touch, whose points move from `start` to `end`, (n, 4, "
      "3) each. `kind`: 'vertex_face', point 0 and the triangle of the others, or 'edge_edge', the "
      "edge of points 0 and 1 and the edge of points 2 and 3. Times (n,) float64 in [0, 1], never "
      "late; infinity without an impact, "
      "NaN if a coordinate is not finite. They touch at a distance of `min_separation`. Times are "
      "early by at most `tolerance`, in (0, 1], or more if `max_intervals` ends the search.");
}

}  // namespace winnow::python
