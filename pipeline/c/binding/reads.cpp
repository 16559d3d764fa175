// Reads the arguments that are structs of their own in C; see convert.h.

#include "pipeline/c/binding/structs.h"

#include <Eigen/Core>

namespace winnow::c {
namespace {

/// Copies three pointers to columns.
template <typename T, typename Columns>
void copy_axes(T* const (&given)[3], Columns& columns) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) columns[axis] = given[axis];
}

template <typename T>
[[nodiscard]] bool are_arrays(const T* const (&axes)[3], std::size_t count) noexcept {
  return is_array(axes[0], count) && is_array(axes[1], count) && is_array(axes[2], count);
}

}  // namespace

bool read(const winnow_execution* given, Execution& execution) noexcept {
  if (given == nullptr) return true;
  switch (given->kind) {
    case WINNOW_EXECUTION_DEFAULT:
      return true;
    case WINNOW_EXECUTION_PARALLEL:
      execution = Execution::parallel();
      return true;
    case WINNOW_EXECUTION_SERIAL:
      execution = Execution::serial();
      return true;
    case WINNOW_EXECUTION_ON: {
      const winnow_job_system& jobs = given->jobs;
      execution = Execution::on({jobs.parallel_for, jobs.context, jobs.threads});
      return jobs.parallel_for != nullptr;
    }
    default:
      return false;
  }
}

namespace {

/// Returns a predicate that calls the one of a C filter, which must outlive it.
template <typename OfC>
[[nodiscard]] ObjectPredicate predicate_of(const OfC* given) noexcept {
  if (given->accept == nullptr) return {};
  return {[](void* context, Key key, ClientData data) {
            const auto& c_filter = *static_cast<const OfC*>(context);
            return c_filter.accept(c_filter.context, {key.id, key.stamp}, data);
          },
          const_cast<OfC*>(given)};
}

}  // namespace

bool read(const winnow_filter* given, Filter& filter) noexcept {
  if (given == nullptr) return true;
  filter = {given->layers, given->mask, given->environment, predicate_of(given)};
  return true;
}

bool read(const winnow_scene_filter* given, SceneFilter& filter) noexcept {
  if (given == nullptr) return true;
  filter = {given->layers,          given->mask,        given->environment, given->layer,
            to_cpp(given->ignored), predicate_of(given)};
  return true;
}

bool read(const winnow_pair_predicate* given, PairPredicate& predicate) noexcept {
  if (given != nullptr) predicate = {given->accept, given->context};
  return true;
}

bool read(const winnow_debug_draw* given, CallbackDraw& drawing) noexcept {
  drawing.draw = *given;
  return true;
}

bool read(const winnow_oriented_box* given, OrientedBox& box) noexcept {
  box.center = Vec3f(given->center);
  box.half = Vec3f(given->half);
  // In C the axes are consecutive rows; in C++ they are the columns of a matrix.
  for (int i = 0; i < 3; ++i) box.axes.set_column(i, Vec3f(given->axes[i]));
  return true;
}

bool read(const winnow_cast* given, Cast& cast) noexcept {
  const Vec3f direction(given->direction);
  switch (given->kind) {
    case WINNOW_CAST_RAY:
      cast = Ray{Vec3f(given->from.origin), direction, given->min_t, given->max_t};
      return true;
    case WINNOW_CAST_BOX:
      cast = BoxCast{*as_cpp(&given->from.box), direction, given->min_t, given->max_t};
      return true;
    case WINNOW_CAST_SPHERE:
      cast = SphereCast{*as_cpp(&given->from.sphere), direction, given->min_t, given->max_t};
      return true;
    case WINNOW_CAST_CAPSULE:
      cast = CapsuleCast{*as_cpp(&given->from.capsule), direction, given->min_t, given->max_t};
      return true;
    default:
      return false;
  }
}

bool read(const winnow_region* given, Region& region) noexcept {
  switch (given->kind) {
    case WINNOW_REGION_POINT:
      region = Vec3f(given->of.point);
      return true;
    case WINNOW_REGION_BOX:
      region = *as_cpp(&given->of.box);
      return true;
    case WINNOW_REGION_ORIENTED_BOX: {
      OrientedBox box;
      const bool is_read = read(&given->of.oriented_box, box);
      region = box;
      return is_read;
    }
    case WINNOW_REGION_SPHERE:
      region = *as_cpp(&given->of.sphere);
      return true;
    case WINNOW_REGION_CAPSULE:
      region = *as_cpp(&given->of.capsule);
      return true;
    case WINNOW_REGION_FRUSTUM:
      region = *as_cpp(&given->of.frustum);
      return true;
    case WINNOW_REGION_PLANES:
      if (!is_array(given->of.planes.planes, given->of.planes.count)) return false;
      region = std::span<const Plane>(as_cpp_span(given->of.planes.planes, given->of.planes.count));
      return true;
    default:
      return false;
  }
}

bool read(const winnow_ray_batch* given, RayBatch& rays) noexcept {
  copy_axes(given->origin, rays.origin);
  copy_axes(given->direction, rays.direction);
  rays.min_t = given->min_t;
  rays.max_t = given->max_t;
  rays.count = given->count;
  rays.stride = given->stride != 0 ? given->stride : sizeof(float);
  return are_arrays(given->origin, given->count) && are_arrays(given->direction, given->count);
}

bool read(const winnow_hit_columns* given, HitColumns& hits) noexcept {
  hits = {as_cpp(given->key), given->data, given->t};
  return true;
}

bool read(const winnow_hull_faces* given, HullFaces& faces) noexcept {
  faces = {span_of(given->indices, given->index_count), span_of(given->sizes, given->face_count)};
  return is_array(given->indices, given->index_count) && is_array(given->sizes, given->face_count);
}

bool read(const winnow_height_samples* given, HeightSamples& samples) noexcept {
  samples = {span_of(given->heights, given->count),
             given->columns,
             given->rows,
             given->row_stride,
             {given->spacing[0], given->spacing[1]}};
  return is_array(given->heights, given->count);
}

bool read(const winnow_moving_bodies* given, MovingBodies& bodies) noexcept {
  bodies = {shape_ids(given->shapes, given->count), as_cpp_span(given->motions, given->count)};
  return is_array(given->shapes, given->count) && is_array(given->motions, given->count);
}

bool read(const winnow_scene_hit_columns* given, SceneHitColumns& hits) noexcept {
  hits = {as_cpp(given->key), given->data, given->part, given->t, {}, {}};
  copy_axes(given->normal, hits.normal);
  copy_axes(given->point, hits.point);
  return true;
}

bool read(const winnow_shape_cast* given, ShapeCast& cast) noexcept {
  cast = {{given->shape}, *as_cpp(&given->pose), Vec3d(given->direction), given->max_t};
  return true;
}

bool read(const winnow_motion_cast* given, MotionCast& cast) noexcept {
  cast = {{given->shape}, *as_cpp(&given->motion), given->from_touch == 0};
  return true;
}

bool read(const winnow_feature_columns* given, FeatureColumns& columns) noexcept {
  columns.count = given->count;
  for (std::size_t k = 0; k < 4; ++k) {
    copy_axes(given->start[k], columns.start[k]);
    copy_axes(given->end[k], columns.end[k]);
  }
  return true;
}

void CallbackDraw::box(const Aabb& box, Colour colour) {
  if (draw.box == nullptr) return;
  winnow_aabb shown;
  *as_cpp(&shown) = box;
  draw.box(draw.context, &shown, {colour.r, colour.g, colour.b, colour.a});
}

void CallbackDraw::line(const Vec3f& from, const Vec3f& to, Colour colour) {
  if (draw.line == nullptr) return;
  draw.line(draw.context, from.data(), to.data(), {colour.r, colour.g, colour.b, colour.a});
}

void CallbackDraw::sphere(const Sphere& sphere, Colour colour) {
  if (draw.sphere == nullptr) return;
  winnow_sphere shown;
  *as_cpp(&shown) = sphere;
  draw.sphere(draw.context, &shown, {colour.r, colour.g, colour.b, colour.a});
}

void CallbackDraw::text(const Vec3f& at, std::string_view text, Colour colour) {
  if (draw.text == nullptr) return;
  draw.text(draw.context, at.data(), text.data(), text.size(),
            {colour.r, colour.g, colour.b, colour.a});
}

Mat4d matrix_by_rows(const double* numbers) noexcept {
  using ByRows = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  return Eigen::Matrix4d(Eigen::Map<const ByRows>(numbers));
}

Answer<Frustum> valid_frustum(const Frustum& frustum) noexcept {
  if (!frustum.is_valid()) return Status::invalid_argument;
  return frustum;
}

Answer<RigidMotion> valid_motion(const RigidMotion& motion) noexcept {
  if (!motion.is_valid()) return Status::invalid_pose;
  return motion;
}

std::array<Vec3d, 4> four_points(const double* numbers) noexcept {
  return {Vec3d(numbers), Vec3d(numbers + 3), Vec3d(numbers + 6), Vec3d(numbers + 9)};
}

ShapeCast from_touch(ShapeCast cast) noexcept {
  cast.touching = false;
  return cast;
}

MeshObstacle obstacle_of(const winnow_mesh_obstacle& given) noexcept {
  return {of(given.shapes), {given.shape}, *as_cpp(&given.motion), given.separation};
}

}  // namespace winnow::c
