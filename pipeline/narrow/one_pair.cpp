// collide() for a single pair of shapes: calls the SIMD kernel of its kinds and, if that cannot
// certify the answer, the much slower solver.

#include "core/threads/float_environment.h"
#include "pipeline/narrow/validate_options.h"
#include "pipeline/shapes/pair_order.h"
#include "pipeline/solver/solver.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr BodyPair kOnlyPair{0, 1};

/// Copies number by number, which `volatile` ensures: callers have often just written the pose, and
/// a load of several numbers would wait until these stores are in the cache (winnow_micro
/// --benchmark_filter=pair/.*/collide).
[[gnu::always_inline]] inline Pose copy_of(const Pose& pose) noexcept {
  Pose copy;
  const volatile double* const position = pose.position.data();
  const volatile double* const orientation = pose.orientation.data();
  for (int i = 0; i < 3; ++i) copy.position[i] = position[i];
  for (int i = 0; i < 4; ++i) copy.orientation[i] = orientation[i];
  return copy;
}

/// A job of one pair and the storage of its answer. Columns that the level does not need are not
/// set.
class OnePair {
 public:
  OnePair(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
          const NarrowOptions& options) noexcept
      : options_(options), shapes_{a, b}, poses_{copy_of(pose_a), copy_of(pose_b)} {
    job_.pairs = &kOnlyPair;
    job_.count = 1;
    job_.shapes = shapes_;
    job_.poses = poses_;
    job_.has_many_bodies = false;
    job_.tables = &tables;
    job_.margin =
        options.contact_margins.empty() ? options.contact_margin : options.contact_margins[0];
    job_.margins = nullptr;
    job_.uncertified = &uncertified_;
  }

  /// Returns false and leaves `answer` unchanged if a pose is not valid.
  [[nodiscard]] bool find(PairAnswer& answer) noexcept {
    const NarrowKernel kernel = kernel_for(shapes_[0].kind(), shapes_[1].kind(), options_);
    if (kernel != nullptr && is_certified_by(kernel)) {
      write(answer);
      return true;
    }
    if (!poses_[0].is_valid() || !poses_[1].is_valid()) return false;
    SolverCounts counts;
    answer = solve_pair(*job_.tables, shapes_[0], poses_[0], shapes_[1], poses_[1], options_.level,
                        job_.margin, counts);
    return true;
  }

 private:
  [[nodiscard]] bool is_certified_by(NarrowKernel kernel) noexcept {
    if (options_.level == ContactLevel::boolean) {
      job_.overlap = &overlap_;
      return kernel(job_) == 0;
    }
    job_.distance = &distance_;
    job_.error_bound = &error_bound_;
    for (int axis = 0; axis < 3; ++axis) {
      job_.normal[axis] = &normal_[axis];
      job_.point[axis] = &point_[axis];
    }
    if (options_.level == ContactLevel::manifold) {
      job_.contact_first = &contact_first_;
      job_.contact_count = &contact_count_;
      job_.contacts = {{position_[0], position_[1], position_[2]}, depth_, feature_, 0};
    }
    return kernel(job_) == 0;
  }

  void write(PairAnswer& answer) const noexcept {
    answer.contact_count = 0;
    if (options_.level == ContactLevel::boolean) {
      answer.overlap = overlap_ != 0;
      return;
    }
    answer.overlap = distance_ <= 0.0;
    answer.distance = distance_;
    answer.error_bound = error_bound_;
    answer.normal = normal_;
    if (options_.level == ContactLevel::distance) {
      answer.point = point_;
      return;
    }
    // A C caller may pass an uninitialized answer, and mirror() reads the point.
    answer.point = {};
    answer.contact_count = contact_count_;
    for (std::uint32_t k = 0; k < contact_count_; ++k) {
      const std::uint32_t i = contact_first_ + k;
      answer.contacts[k] = {
          {position_[0][i], position_[1][i], position_[2][i]}, depth_[i], feature_[i]};
    }
  }

  static constexpr std::size_t kRoom = kManifoldPoints + kContactSlack;

  const NarrowOptions& options_;
  const ShapeId shapes_[2];
  const Pose poses_[2];
  NarrowJob job_;
  std::uint32_t uncertified_;
  std::uint8_t overlap_;
  double distance_;
  double error_bound_;
  double normal_[3];
  double point_[3];
  std::uint32_t contact_first_;
  std::uint32_t contact_count_;
  float position_[3][kRoom];
  float depth_[kRoom];
  std::uint64_t feature_[kRoom];
};

}  // namespace

Status collide(const ShapePool& shapes, ShapeId a, const Pose& pose_a, ShapeId b,
               const Pose& pose_b, const NarrowOptions& options, PairAnswer& answer) noexcept {
  return collide(shapes.tables(), a, pose_a, b, pose_b, options, answer);
}

Status collide(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
               const Pose& pose_b, const NarrowOptions& options, PairAnswer& answer) noexcept {
  const DefaultFloatEnvironment environment;
  if (options.contact_margins.size() > 1) return Status::size_mismatch;
  if (!are_valid(options)) return Status::invalid_argument;
  if (!has_shape(tables, a) || !has_shape(tables, b)) return Status::invalid_key;
  if (!is_mirrored(a, b)) {
    OnePair pair(tables, a, pose_a, b, pose_b, options);
    return pair.find(answer) ? Status::ok : Status::invalid_pose;
  }
  OnePair pair(tables, b, pose_b, a, pose_a, options);
  if (!pair.find(answer)) return Status::invalid_pose;
  if (options.level != ContactLevel::boolean) mirror(pose_a, pose_b, answer);
  return Status::ok;
}

}  // namespace winnow
