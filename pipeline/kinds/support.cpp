#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

#include <Eigen/Core>

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X)       \
  WINNOW_X(sphere, support)          \
  WINNOW_X(box, support)             \
  WINNOW_X(half_space, support)      \
  WINNOW_X(capsule, support)         \
  WINNOW_X(triangle, support)        \
  WINNOW_X(hull, support)            \
  WINNOW_X(cylinder, support)        \
  WINNOW_X(cone, support)            \
  WINNOW_X(ellipsoid, support)       \
  WINNOW_X(tapered_capsule, support) \
  WINNOW_X(support, support)
WINNOW_DEFINE_LINK(support, WINNOW_PAIRS)
#undef WINNOW_PAIRS

namespace {

using Eigen::Vector3d;

/// The support points along the 26 directions to the corners, edges and faces of a cube.
class SupportProbe {
 public:
  explicit SupportProbe(const SupportShape& shape) noexcept {
    for (int i = 0; i < 27; ++i) {
      const Vector3d out(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      if (out.isZero(0.0)) continue;
      direction_[count_] = out.normalized();
      shape.function(shape.context, direction_[count_].data(), point_[count_].data());
      ++count_;
    }
  }

  /// Returns whether all points are finite and within the radius, and each is the farthest of all
  /// points along its own direction.
  [[nodiscard]] bool is_convex(double radius) const noexcept {
    const double doubt = 1e-9 * radius;
    for (int i = 0; i < kCount; ++i) {
      if (!point_[i].allFinite() || point_[i].stableNorm() > radius + doubt) return false;
    }
    for (int i = 0; i < kCount; ++i) {
      for (const Vector3d& point : point_) {
        if (direction_[i].dot(point - point_[i]) > doubt) return false;
      }
    }
    return true;
  }

 private:
  static constexpr int kCount = 26;
  Vector3d direction_[kCount];
  Vector3d point_[kCount];
  int count_ = 0;
};

}  // namespace

Answer<ShapeId> ShapePool::add(const SupportShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius, shape.rounding}) || shape.function == nullptr ||
      !SupportProbe(shape).is_convex(shape.radius)) {
    return Status::invalid_shape;
  }
  link_kernels_of_support();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
