// C binding of float volumes made from double or from a camera, and of debug drawing.

#include <winnow/c/volumes.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/drawing.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"

#include <winnow/core/kdop_around.h>

#include <algorithm>

namespace winnow::c {
namespace {

template <int K>
void write_kdop(const OrientedBox& box, float* slabs) noexcept {
  const Kdop<K> around = kdop_around<K>(box);
  std::copy(around.max.begin(), around.max.end(),
            std::copy(around.min.begin(), around.min.end(), slabs));
}

}  // namespace

CallbackDraw::CallbackDraw(const winnow_debug_draw& draw) noexcept : draw_(draw) {}

void CallbackDraw::box(const Aabb& box, Colour colour) {
  if (draw_.box == nullptr) return;
  winnow_aabb shown;
  *as_cpp(&shown) = box;
  draw_.box(draw_.context, &shown, of(colour));
}

void CallbackDraw::line(const Vec3f& from, const Vec3f& to, Colour colour) {
  if (draw_.line != nullptr) draw_.line(draw_.context, from.data(), to.data(), of(colour));
}

void CallbackDraw::sphere(const Sphere& sphere, Colour colour) {
  if (draw_.sphere == nullptr) return;
  winnow_sphere shown;
  *as_cpp(&shown) = sphere;
  draw_.sphere(draw_.context, &shown, of(colour));
}

void CallbackDraw::text(const Vec3f& at, std::string_view text, Colour colour) {
  if (draw_.text == nullptr) return;
  draw_.text(draw_.context, at.data(), text.data(), text.size(), of(colour));
}

bool read_options(const winnow_debug_draw_options* given, DebugDrawOptions& options) noexcept {
  winnow_debug_draw_options own{};
  if (!read_sized(given, own)) return false;
  options.objects = own.leave_out_objects == 0;
  options.structure = own.leave_out_structure == 0;
  options.labels = own.labels != 0;
  take_given(own.max_depth, options.max_depth);
  return true;
}

}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_aabb_outward(const double min[3], const double max[3], const double origin[3],
                                  winnow_aabb* box) {
  if (!are_given(min, max, box)) return WINNOW_INVALID_ARGUMENT;
  const Eigen::Vector3d low(min);
  const Eigen::Vector3d high(max);
  *as_cpp(box) = origin == nullptr ? winnow::Aabb::outward(low, high)
                                   : winnow::Aabb::outward(low, high, Eigen::Vector3d(origin));
  return WINNOW_OK;
}

winnow_status winnow_kdop_around(uint32_t k, const winnow_oriented_box* box, float* slabs) {
  if (!are_given(box, slabs)) return WINNOW_INVALID_ARGUMENT;
  const winnow::OrientedBox turned = oriented_box_of(*box);
  if (!turned.is_valid()) return WINNOW_INVALID_BOUNDS;
  if (k == 14) {
    write_kdop<14>(turned, slabs);
  } else if (k == 18) {
    write_kdop<18>(turned, slabs);
  } else if (k == 26) {
    write_kdop<26>(turned, slabs);
  } else {
    return WINNOW_INVALID_ARGUMENT;
  }
  return WINNOW_OK;
}

winnow_status winnow_frustum_perspective(const float eye[3], const float forward[3],
                                         const float up[3], float vertical_fov, float aspect,
                                         float near_t, float far_t, winnow_frustum* frustum) {
  if (!are_given(eye, forward, up, frustum)) return WINNOW_INVALID_ARGUMENT;
  const winnow::Frustum made =
      winnow::Frustum::perspective(Eigen::Vector3f(eye), Eigen::Vector3f(forward),
                                   Eigen::Vector3f(up), vertical_fov, aspect, near_t, far_t);
  if (!made.is_valid()) return WINNOW_INVALID_ARGUMENT;
  *as_cpp(frustum) = made;
  return WINNOW_OK;
}

winnow_status winnow_frustum_from_matrix(const double clip_from_world[16], int32_t near_depth,
                                         winnow_frustum* frustum) {
  winnow::Frustum::NearDepth depth{};
  if (!are_given(clip_from_world, frustum) ||
      !read_choice(near_depth, winnow::Frustum::NearDepth::minus_one, depth)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  using ByRows = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Matrix4d matrix = Eigen::Map<const ByRows>(clip_from_world);
  const winnow::Frustum made = winnow::Frustum::from_matrix(matrix, depth);
  if (!made.is_valid()) return WINNOW_INVALID_ARGUMENT;
  *as_cpp(frustum) = made;
  return WINNOW_OK;
}
