#pragma once

/// Bounding volumes in float, poses, and views of the caller's columns. A view is read only during
/// the call, and without a copy if its number type is that of the engine. Other numbers are
/// converted; boxes in double are rounded outward to float.

#include <winnow/c/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Closed box; bounds may be infinite.
typedef struct winnow_aabb {
  float min[3];
  float max[3];
} winnow_aabb;

typedef struct winnow_sphere {
  float center[3];
  float radius;
} winnow_sphere;

typedef struct winnow_capsule {
  float a[3];
  float b[3];
  float radius;
} winnow_capsule;

/// The points center + sum of s_i axes[i] with |s_i| <= half[i].
typedef struct winnow_oriented_box {
  float center[3];
  float half[3];
  float axes[3][3];  ///< three unit vectors
} winnow_oriented_box;

/// The points p with normal . p + offset >= 0.
typedef struct winnow_plane {
  float normal[3];
  float offset;
} winnow_plane;

/// View volume of a camera: inward-facing planes (left, right, bottom, top, near, far), and a box
/// that contains the volume, infinite if unknown.
typedef struct winnow_frustum {
  winnow_plane planes[6];
  winnow_aabb bounds;
} winnow_frustum;

/// Pose of a body: x -> position + R(orientation) x. The orientation is a quaternion w, x, y, z of
/// any nonzero length.
typedef struct winnow_pose {
  double position[3];
  double orientation[4];
} winnow_pose;
#define WINNOW_POSE      \
  {                      \
    {0.0, 0.0, 0.0}, {   \
      1.0, 0.0, 0.0, 0.0 \
    }                    \
  }

/// Computes the smallest float box that contains the double box, relative to `origin` unless that
/// is null.
WINNOW_C_API winnow_status winnow_aabb_outward(const double min[3], const double max[3],
                                               const double origin[3], winnow_aabb* box);

/// Computes the k-DOP (k = 14, 18 or 26) of an oriented box: k/2 lower bounds of its slabs, then
/// k/2 upper bounds, rounded outward.
WINNOW_C_API winnow_status winnow_kdop_around(uint32_t k, const winnow_oriented_box* box,
                                              float* slabs);

/// See Frustum::perspective. WINNOW_INVALID_ARGUMENT if the result would be invalid.
WINNOW_C_API winnow_status winnow_frustum_perspective(const float eye[3], const float forward[3],
                                                      const float up[3], float vertical_fov,
                                                      float aspect, float near_t, float far_t,
                                                      winnow_frustum* frustum);

/// Depth of the near plane in clip space.
enum { WINNOW_NEAR_DEPTH_ZERO = 0, WINNOW_NEAR_DEPTH_MINUS_ONE = 1 };
/// Computes a frustum from a row-major matrix that maps column vectors from world to clip space.
WINNOW_C_API winnow_status winnow_frustum_from_matrix(const double clip_from_world[16],
                                                      int32_t near_depth, winnow_frustum* frustum);

/// Number type of a view.
typedef int32_t winnow_number;
enum { WINNOW_FLOAT = 0, WINNOW_DOUBLE = 1 };
/// Index type of a view.
enum { WINNOW_UINT32 = 0, WINNOW_UINT16 = 1 };

/// Strides are bytes from one entry to the next. 0 means entries without gaps.

typedef struct winnow_box_view {
  const void* min[3];
  const void* max[3];
  size_t stride;
  size_t count;
  winnow_number number;
} winnow_box_view;

typedef struct winnow_point_view {
  const void* axis[3];
  size_t stride;
  size_t count;
  winnow_number number;
} winnow_point_view;

/// Triangles as vertex indices. The three indices of a triangle are contiguous. Stride 0 means
/// triangles without gaps.
typedef struct winnow_index_view {
  const void* corners;
  size_t stride;
  size_t count;
  int32_t index;  ///< WINNOW_UINT32 or WINNOW_UINT16
} winnow_index_view;

/// If all four orientation pointers are null, moved bodies keep their orientation, and poses that
/// are read have the identity.
typedef struct winnow_pose_view {
  const void* position[3];
  const void* orientation[4];
  size_t position_stride;
  size_t orientation_stride;
  size_t count;
  winnow_number position_number;
  winnow_number orientation_number;
} winnow_pose_view;

// Views of arrays of structs.

static inline winnow_box_view winnow_boxes(const winnow_aabb* boxes, size_t count) {
  winnow_box_view view = {{NULL, NULL, NULL}, {NULL, NULL, NULL}, 0, 0, WINNOW_FLOAT};
  if (boxes != NULL) {
    for (int axis = 0; axis < 3; ++axis) {
      view.min[axis] = boxes->min + axis;
      view.max[axis] = boxes->max + axis;
    }
  }
  view.stride = sizeof(winnow_aabb);
  view.count = count;
  return view;
}

/// Coordinates x, y, z of each point are adjacent.
static inline winnow_point_view winnow_points(const double* points, size_t count) {
  winnow_point_view view = {{NULL, NULL, NULL}, 0, 0, WINNOW_DOUBLE};
  if (points != NULL) {
    for (int axis = 0; axis < 3; ++axis) view.axis[axis] = points + axis;
  }
  view.stride = 3 * sizeof(double);
  view.count = count;
  return view;
}

static inline winnow_pose_view winnow_poses(const winnow_pose* poses, size_t count) {
  winnow_pose_view view = {{NULL, NULL, NULL}, {NULL, NULL, NULL, NULL}, 0, 0, 0, WINNOW_DOUBLE,
                           WINNOW_DOUBLE};
  if (poses != NULL) {
    for (int axis = 0; axis < 3; ++axis) view.position[axis] = poses->position + axis;
    for (int k = 0; k < 4; ++k) view.orientation[k] = poses->orientation + k;
  }
  view.position_stride = sizeof(winnow_pose);
  view.orientation_stride = sizeof(winnow_pose);
  view.count = count;
  return view;
}

// Callbacks for drawing partitions and scenes. Each may be null. Pointers passed to them are valid
// only during the call. See DebugDraw.

typedef struct winnow_colour {
  uint8_t r, g, b, a;
} winnow_colour;

typedef struct winnow_debug_draw {
  void* context;
  void (*box)(void* context, const winnow_aabb* box, winnow_colour colour);
  void (*line)(void* context, const float from[3], const float to[3], winnow_colour colour);
  void (*sphere)(void* context, const winnow_sphere* sphere, winnow_colour colour);
  /// `text` is not null-terminated.
  void (*text)(void* context, const float at[3], const char* text, size_t length,
               winnow_colour colour);
} winnow_debug_draw;

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_debug_draw_options {
  size_t size;                ///< set by the caller to sizeof(winnow_debug_draw_options)
  uint8_t leave_out_objects;  ///< 0 or 1, like the next two
  uint8_t leave_out_structure;
  uint8_t labels;
  int32_t max_depth;  ///< 0 means 64
} winnow_debug_draw_options;
#define WINNOW_DEBUG_DRAW_OPTIONS \
  { sizeof(winnow_debug_draw_options), 0, 0, 0, 64 }

#ifdef __cplusplus
}
#endif
