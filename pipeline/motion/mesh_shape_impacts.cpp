// Impacts of a rigid shape with a DeformableMesh: faces whose boxes overlap the shape's swept box
// are tested one by one, as triangles that deform while they travel.

#include <winnow/pipeline/deformable_mesh.h>

#include "core/sort/parallel_ranges.h"
#include "core/threads/float_environment.h"
#include "pipeline/motion/deformable_faces.h"
#include "pipeline/motion/face_impact.h"
#include "pipeline/motion/relative_motion_bounds.h"
#include "pipeline/motion/result_chunk.h"

namespace winnow {
namespace {

constexpr std::size_t kFacesPerRange = 16;

[[nodiscard]] Status status_of(const SubShapeQuery& parts, const MeshObstacle& obstacle,
                               const ImpactOptions& options) noexcept {
  if (!(options.tolerance > 0.0 && options.tolerance <= 1.0)) return Status::invalid_argument;
  if (obstacle.shape.is_composite() && options.composites == nullptr) return Status::unsupported;
  if (!parts.contains(obstacle.shape)) return Status::invalid_key;
  return obstacle.motion.is_valid() ? Status::ok : Status::invalid_pose;
}

/// Returns a box, relative to `origin`, that contains the shape during its motion, enlarged by the
/// separation.
[[nodiscard]] Aabb swept_box(const SubShapeQuery& parts, const MeshObstacle& obstacle,
                             const Vec3d& origin) noexcept {
  const RigidMotion frame = RigidMotion::stationary(Pose::at(origin.x(), origin.y(), origin.z()));
  const impact::MovingShape whole = impact::whole_shape(parts, obstacle.shape, obstacle.motion);
  const mid::Box3 box =
      impact::RelativeMotionBounds(parts, frame, whole).box({0.0, 1.0}).grown(obstacle.separation);
  return Aabb::outward(box.min, box.max);
}

[[nodiscard]] MeshShapeImpact shown(std::uint32_t face, const MeshObstacle& obstacle,
                                    const impact::BodyImpact& found) noexcept {
  MeshShapeImpact result;
  result.face = face;
  result.part = found.part_a;
  result.time = found.impact.time;
  result.gap = found.impact.gap;
  result.error_bound = found.impact.error_bound;
  const RigidMotion& motion = obstacle.motion;
  for (int i = 0; i < 3; ++i) {
    result.normal[i] = found.impact.normal[i];
    result.point[i] =
        motion.start.position[i] + result.time * motion.travel[i] + found.impact.point[i];
  }
  return result;
}

}  // namespace

Status DeformableMesh::impacts_with(const MeshObstacle& obstacle, const ImpactOptions& options,
                                    ResultChunks<MeshShapeImpact> chunks) const noexcept {
  const DefaultFloatEnvironment environment;
  const SubShapeQuery parts(obstacle.shapes, options.composites);
  const Faces faces_of_mesh{*this};
  if (!faces_of_mesh.are_moved() ||
      !(obstacle.separation >= 0.0 && obstacle.separation <= 0.5 * faces_of_mesh.reach())) {
    return Status::invalid_argument;
  }
  if (const Status status = status_of(parts, obstacle, options); status != Status::ok) {
    return status;
  }
  ResultChunk<MeshShapeImpact> results(options_.memory, chunks);
  Column<impact::BodyImpact> found(options_.memory);
  if (!results.reserve(options_.chunk) || !found.resize(options_.chunk)) {
    return Status::out_of_memory;
  }
  const auto impact_of = [&](std::uint32_t number) {
    std::array<Vec3d, 3> start;
    std::array<Vec3d, 3> end;
    faces_of_mesh.place(number, start, end);
    impact::MovingFace face;
    face.rounding = obstacle.separation;
    for (std::size_t i = 0; i < 3; ++i) {
      face.start[i] = start[i];
      face.end[i] = end[i];
    }
    return impact::find_face_impact(parts, {obstacle.shape, obstacle.motion}, face,
                                    options.tolerance);
  };
  const auto take = [&](std::span<const Pair> faces) {
    for_each_range(options_.execution, faces.size(), kFacesPerRange,
                   [&](std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i)
                       found[i] = impact_of(faces[i].second);
                   });
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (found[i].impact.hit) results.add(shown(faces[i].second, obstacle, found[i]));
    }
  };
  const Status status = faces_of_mesh.find(swept_box(parts, obstacle, options_.origin), take);
  if (status != Status::ok) return status;
  results.flush();
  return Status::ok;
}

}  // namespace winnow
