#pragma once

/// Volumes in float, poses, and columns of numbers where the caller keeps them. A view is read
/// where it lies and while the call lasts; of double, what the engine keeps in float is rounded
/// outward first.

#include <winnow/c/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Closed boxes; ends may be infinite.
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

/// What a camera sees: planes that face inward (left, right, bottom, top, near, far), and a box
/// around what lies within them, infinite where not known.
typedef struct winnow_frustum {
  winnow_plane planes[6];
  winnow_aabb bounds;
} winnow_frustum;

/// Where a body is: x -> position + R(orientation) x; a quaternion w, x, y, z of any length but 0.
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

/// The smallest float box that contains the double box, measured from `origin` unless that is null.
WINNOW_C_API winnow_status winnow_aabb_outward(const double min[3], const double max[3],
                                               const double origin[3], winnow_aabb* box);

/// The k-DOP (k = 14, 18 or 26) of a turned box: k/2 lower ends of its slabs, then k/2 upper ones,
/// rounded outward.
WINNOW_C_API winnow_status winnow_kdop_around(uint32_t k, const winnow_oriented_box* box,
                                              float* slabs);

/// See Frustum::perspective. WINNOW_INVALID_ARGUMENT where that is invalid.
WINNOW_C_API winnow_status winnow_frustum_perspective(const float eye[3], const float forward[3],
                                                      const float up[3], float vertical_fov,
                                                      float aspect, float near_t, float far_t,
                                                      winnow_frustum* frustum);

/// Depth that the near plane has in clip space.
enum { WINNOW_NEAR_DEPTH_ZERO = 0, WINNOW_NEAR_DEPTH_MINUS_ONE = 1 };
/// From a matrix, row by row, that takes column vectors of the world to clip space.
WINNOW_C_API winnow_status winnow_frustum_from_matrix(const double clip_from_world[16],
                                                      int32_t near_depth, winnow_frustum* frustum);

/// What the numbers of a view are.
typedef int32_t winnow_number;
enum { WINNOW_FLOAT = 0, WINNOW_DOUBLE = 1 };
/// What indices are.
enum { WINNOW_UINT32 = 0, WINNOW_UINT16 = 1 };

/// Strides are bytes from one entry to the next; 0 stands for columns without gaps.

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

/// Triangles as corners' numbers; the three of a triangle are contiguous, and a stride of 0 stands
/// for triangles without gaps.
typedef struct winnow_index_view {
  const void* corners;
  size_t stride;
  size_t count;
  int32_t index;  ///< WINNOW_UINT32, WINNOW_UINT16
} winnow_index_view;

/// Without orientations (all four null) bodies that are moved do not turn, and poses that are read
/// have the identity.
typedef struct winnow_pose_view {
  const void* position[3];
  const void* orientation[4];
  size_t position_stride;
  size_t orientation_stride;
  size_t count;
  winnow_number position_number;
  winnow_number orientation_number;
} winnow_pose_view;

// Arrays of structs as views.

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

/// x, y, z of each point next to each other.
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

// What partitions and scenes draw themselves with. Each call may be null; what it is given is valid
// while it lasts. See DebugDraw.

typedef struct winnow_colour {
  uint8_t r, g, b, a;
} winnow_colour;

typedef struct winnow_debug_draw {
  void* context;
  void (*box)(void* context, const winnow_aabb* box, winnow_colour colour);
  void (*line)(void* context, const float from[3], const float to[3], winnow_colour colour);
  void (*sphere)(void* context, const winnow_sphere* sphere, winnow_colour colour);
  /// Not ended by a zero.
  void (*text)(void* context, const float at[3], const char* text, size_t length,
               winnow_colour colour);
} winnow_debug_draw;

/// Null, and zeros behind `size`, stand for what C++ has by default.
typedef struct winnow_debug_draw_options {
  size_t size;                ///< sizeof(winnow_debug_draw_options), of the caller
  uint8_t leave_out_objects;  ///< 0 or 1, as the next two
  uint8_t leave_out_structure;
  uint8_t labels;
  int32_t max_depth;  ///< 0: 64
} winnow_debug_draw_options;
#define WINNOW_DEBUG_DRAW_OPTIONS \
  { sizeof(winnow_debug_draw_options), 0, 0, 0, 64 }

#ifdef __cplusplus
}
#endif
