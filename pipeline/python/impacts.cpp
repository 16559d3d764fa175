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

/// Throws the error of the first pair that failed.
void accept_all(const ImpactResult& result) {
  const auto bad = std::find_if(result.status().begin(), result.status().end(),
                                [](Status status) { return status != Status::ok; });
  if (bad == result.status().end()) return;
  accept(*bad, "time_of_impact, pair " + std::to_string(bad - result.status().begin()));
}

[[nodiscard]] py::object shape_impacts(const SharedShapes& shapes, py::handle shape_of,
                                       py::handle motions, py::handle pair_array, double tolerance,
                                       bool parallel) {
  RigidMotionInput motion(motions);
  ShapeInput shape(shapes, shape_of, "shape_of");
  Integers<std::uint32_t> pairs(pair_array, "pairs", 2);
  pairs.limit(agree({&motion, &shape}));
  static_assert(sizeof(BodyPair) == 2 * sizeof(std::uint32_t));
  const std::span<const BodyPair> list(reinterpret_cast<const BodyPair*>(pairs.values().data()),
                                       pairs.count());
  const auto result = std::make_shared<ImpactResult>();
  accept(reading_shapes(shapes,
                        [&] {
                          std::vector<RigidMotion> room;
                          const ImpactOptions options{
                              tolerance, parallel ? Execution::parallel() : Execution::serial(),
                              &shapes.composites};
                          return time_of_impact(shapes.pool, {shape.list(), motion.packed(room)},
                                                list, options, *result);
                        }),
         "time_of_impact");
  accept_all(*result);
  const auto column = [&](const auto& values) {
    return shown(std::shared_ptr<const void>(result), values.data(), values.size());
  };
  auto hit = fresh<bool>(result->size());
  std::copy(result->hit().begin(), result->hit().end(), hit.mutable_data());
  return table("Impacts", hit, column(result->time()), column(result->gap()),
               column(result->error_bound()),
               vectors([&](int axis) { return result->normal(axis); }),
               vectors([&](int axis) { return result->point(axis); }), column(result->part_a()),
               column(result->part_b()));
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
  Numbers start(starts, "start", {4, 3});
  Numbers end(ends, "end", {4, 3});
  const std::size_t count = agree({&start, &end});
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
  add_function(module, "time_of_impact", &shape_impacts);
  add_function(module, "feature_impacts", &feature_times);
}

}  // namespace winnow::python
