#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/hull_builder.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X) \
  WINNOW_X(sphere, hull)       \
  WINNOW_X(box, hull)          \
  WINNOW_X(hull, half_space)   \
  WINNOW_X(capsule, hull)      \
  WINNOW_X(hull, triangle)     \
  WINNOW_X(hull, hull)
WINNOW_DEFINE_LINK(hull, WINNOW_PAIRS)
#undef WINNOW_PAIRS

void link_hull_kernels() noexcept {
  link_kernels_of_hull();
}

namespace {

/// Builds a hull with `make` and adds it, if `rounding` is valid.
template <typename Make>
Answer<ShapeId> put_hull(ShapePool& pool, std::pmr::memory_resource* memory, double rounding,
                         Make&& make) {
  HullShape hull;
  if (!are_lengths({rounding})) return Status::invalid_shape;
  const Status status = make(hull);
  if (status != Status::ok) return status;
  hull.rounding = rounding;
  link_kernels_of_hull();
  const Answer<ShapeId> id = PoolRows::put(pool, hull);
  if (id.status != Status::ok) release_hull(hull, memory);
  return id;
}

}  // namespace

Answer<ShapeId> ShapePool::add_hull(const PointView& points, double rounding) {
  const DefaultFloatEnvironment environment;
  return put_hull(*this, memory_, rounding,
                  [&](HullShape& hull) { return hull_of_points(points, memory_, hull); });
}

Answer<ShapeId> ShapePool::add_hull(const PointView& points, const HullFaces& faces,
                                    double rounding) {
  const DefaultFloatEnvironment environment;
  return put_hull(*this, memory_, rounding,
                  [&](HullShape& hull) { return hull_of_faces(points, faces, memory_, hull); });
}

Answer<ShapeId> ShapePool::add_built_hull(const PointView& points, const HullFaces& faces,
                                          double rounding) {
  const DefaultFloatEnvironment environment;
  return put_hull(*this, memory_, rounding,
                  [&](HullShape& hull) { return rebuild_hull(points, faces, memory_, hull); });
}

}  // namespace winnow
