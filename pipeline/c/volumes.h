// Generated from pipeline/interface/volumes.toml; do not edit.
// clang-format off
#pragma once

/// Bounding volumes in float, poses, and views of the caller's columns. A view is read only during
/// the call, and without a copy if its number type is the one of the engine. Other numbers are
/// converted; boxes in double are rounded outward to float.

#include <winnow/c/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Depth of the near plane in clip space.
enum {
  WINNOW_NEAR_DEPTH_ZERO = 0,      ///< Vulkan, Direct3D and Metal
  WINNOW_NEAR_DEPTH_MINUS_ONE = 1  ///< OpenGL
};

/// Number type of a view.
typedef int32_t winnow_number;
enum {
  WINNOW_FLOAT = 0,
  WINNOW_DOUBLE = 1
};

/// Index type of a view.
enum {
  WINNOW_UINT32 = 0,
  WINNOW_UINT16 = 1
};

/// Closed box; bounds may be infinite.
typedef struct winnow_aabb {
  float min[3];  ///< lower corner
  float max[3];  ///< upper corner
} winnow_aabb;

/// Ball.
typedef struct winnow_sphere {
  float center[3];  ///< its centre
  float radius;     ///< finite, >= 0
} winnow_sphere;

/// The points whose distance from a segment is at most the radius.
typedef struct winnow_capsule {
  float a[3];    ///< end of the segment
  float b[3];    ///< other end
  float radius;  ///< finite, >= 0
} winnow_capsule;

/// The points center + sum of s_i axes[i] with |s_i| <= half[i].
typedef struct winnow_oriented_box {
  float center[3];   ///< its centre
  float half[3];     ///< half of each edge
  float axes[3][3];  ///< three unit vectors
} winnow_oriented_box;

/// The points p with normal . p + offset >= 0.
typedef struct winnow_plane {
  float normal[3];  ///< of any length but 0
  float offset;     ///< signed distance of the origin times the normal's length
} winnow_plane;

/// View volume of a camera.
typedef struct winnow_frustum {
  winnow_plane planes[6];  ///< inward-facing: left, right, bottom, top, near, far
  winnow_aabb bounds;      ///< contains the volume; infinite if unknown
} winnow_frustum;

/// Pose of a body: x -> position + R(orientation) x.
typedef struct winnow_pose {
  double position[3];     ///< where the origin of the body is
  double orientation[4];  ///< quaternion w, x, y, z of any nonzero length
} winnow_pose;
#define WINNOW_POSE {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}

/// Boxes in columns, or members of any struct. A stride is the bytes from one entry to the next; 0
/// means no gaps.
typedef struct winnow_box_view {
  const void* min[3];    ///< lower corner of the first box: x, y, z
  const void* max[3];    ///< upper corner of the first box
  size_t stride;         ///< bytes from one box to the next
  size_t count;          ///< number of boxes
  winnow_number number;  ///< of all columns
} winnow_box_view;

/// Points in columns, or members of any struct.
typedef struct winnow_point_view {
  const void* axis[3];   ///< x, y and z of the first point
  size_t stride;         ///< bytes from one point to the next; 0 means no gaps
  size_t count;          ///< number of points
  winnow_number number;  ///< of all columns
} winnow_point_view;

/// Triangles as vertex indices. The three indices of a triangle are contiguous.
typedef struct winnow_index_view {
  const void* corners;  ///< indices of the first triangle
  size_t stride;        ///< bytes from one triangle to the next; 0 means no gaps
  size_t count;         ///< number of triangles
  int32_t index;        ///< WINNOW_UINT32 or WINNOW_UINT16
} winnow_index_view;

/// Poses in columns, or members of any struct. If all four orientation pointers are null, moved
/// bodies keep their orientation, and poses that are read have the identity. Strides of 0 mean no
/// gaps.
typedef struct winnow_pose_view {
  const void* position[3];           ///< x, y and z of the first position
  const void* orientation[4];        ///< w, x, y and z of the first orientation
  size_t position_stride;            ///< bytes from one position to the next
  size_t orientation_stride;         ///< bytes from one orientation to the next
  size_t count;                      ///< number of poses
  winnow_number position_number;     ///< of the positions
  winnow_number orientation_number;  ///< of the orientations
} winnow_pose_view;

/// Red, green, blue and opacity.
typedef struct winnow_colour {
  uint8_t r, g, b, a;  ///< each 0 to 255
} winnow_colour;

/// Callbacks for drawing partitions and scenes, called on the calling thread. Each may be null.
/// Pointers passed to them are valid only during the call. The structure comes first, then the
/// objects in ascending order of their ids.
typedef struct winnow_debug_draw {
  void* context;  ///< passed to all functions
  /// Draws the edges of a box, which may be infinite.
  void (*box)(void* context, const winnow_aabb* box, winnow_colour colour);
  /// Draws a segment.
  void (*line)(void* context, const float from[3], const float to[3], winnow_colour colour);
  /// Draws a ball, or its outline.
  void (*sphere)(void* context, const winnow_sphere* sphere, winnow_colour colour);
  /// Draws a label; `text` is not null-terminated.
  void (*text)(void* context, const float at[3], const char* text, size_t length,
               winnow_colour colour);
} winnow_debug_draw;

/// Selects what is drawn. A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_debug_draw_options {
  size_t size;                  ///< set by the caller to sizeof(winnow_debug_draw_options)
  uint8_t leave_out_objects;    ///< 0 or 1: does not draw the volumes of objects
  uint8_t leave_out_structure;  ///< 0 or 1: does not draw cells, strips and nodes
  uint8_t labels;               ///< 0 or 1: draws the client data of every object as text
  int32_t max_depth;            ///< levels of the node tree, counted from the root; 0 means 64
} winnow_debug_draw_options;
#define WINNOW_DEBUG_DRAW_OPTIONS {sizeof(winnow_debug_draw_options), 0, 0, 0, 64}

/// Computes the smallest float box that contains the double box, relative to `origin` unless that
/// is null.
WINNOW_C_API winnow_status winnow_aabb_outward(
    const double min[3], const double max[3], const double origin[3], winnow_aabb* box);

/// Computes the k-DOP (k = 14, 18 or 26) of an oriented box: k/2 lower bounds of its slabs, then
/// k/2 upper bounds, rounded outward. `slabs` has room for k numbers. WINNOW_INVALID_BOUNDS for an
/// invalid box.
WINNOW_C_API winnow_status winnow_kdop_around(
    uint32_t k, const winnow_oriented_box* box, float* slabs);

/// Computes the frustum of a camera at `eye` that looks along `forward` (any length), with `up`
/// roughly upward. The vertical field of view is in radians, in (0, pi); aspect = width / height >
/// 0. `near_t` and `far_t` are distances along `forward`: 0 <= near_t < far_t, far_t finite.
/// WINNOW_INVALID_ARGUMENT if the result would be invalid.
WINNOW_C_API winnow_status winnow_frustum_perspective(
    const float eye[3], const float forward[3], const float up[3], float vertical_fov, float aspect,
    float near_t, float far_t, winnow_frustum* frustum);

/// Computes a frustum from a row-major matrix that maps column vectors from world to clip space.
/// WINNOW_INVALID_ARGUMENT if the result would be invalid.
WINNOW_C_API winnow_status winnow_frustum_from_matrix(
    const double clip_from_world[16], int32_t near_depth, winnow_frustum* frustum);

/* Views of arrays of structs. */

/// Views an array of boxes.
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

/// Views an array of points, whose coordinates x, y, z are adjacent.
static inline winnow_point_view winnow_points(const double* points, size_t count) {
  winnow_point_view view = {{NULL, NULL, NULL}, 0, 0, WINNOW_DOUBLE};
  if (points != NULL) {
    for (int axis = 0; axis < 3; ++axis) view.axis[axis] = points + axis;
  }
  view.stride = 3 * sizeof(double);
  view.count = count;
  return view;
}

/// Views an array of poses.
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

#ifdef __cplusplus
}
#endif
