#pragma once

/// Convex shapes and composite shapes. <winnow/pipeline/shapes.h>, shape_pool.h, composite_pool.h,
/// triangle_mesh.h, height_field.h and shape_rays.h document each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/volumes.h>

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Id of a shape of either pool: its kind (upper four bits) and its index among shapes of that
/// kind.
typedef uint32_t winnow_shape_id;
#define WINNOW_NO_SHAPE 0xFFFFFFFFU

typedef int32_t winnow_shape_kind;
enum {
  WINNOW_SHAPE_SPHERE = 0,
  WINNOW_SHAPE_CAPSULE = 1,
  WINNOW_SHAPE_BOX = 2,
  WINNOW_SHAPE_CYLINDER = 3,
  WINNOW_SHAPE_CONE = 4,
  WINNOW_SHAPE_HULL = 5,
  WINNOW_SHAPE_TRIANGLE = 6,
  WINNOW_SHAPE_HALF_SPACE = 7,
  WINNOW_SHAPE_MESH = 8,
  WINNOW_SHAPE_COMPOUND = 9,
  WINNOW_SHAPE_HEIGHT_FIELD = 10,
  WINNOW_SHAPE_ELLIPSOID = 11,
  WINNOW_SHAPE_TAPERED_CAPSULE = 12,
  WINNOW_SHAPE_SUPPORT = 13
};
/// Returns the name of a kind, such as "sphere"; "none" if it is invalid.
WINNOW_C_API const char* winnow_shape_kind_name(winnow_shape_kind kind);

/// Support function of a user shape. `direction` and `point` are arrays of three numbers.
typedef void (*winnow_support_function)(const void* context, const double* direction,
                                        double* point);

/// A convex shape other than a hull.
typedef struct winnow_shape {
  winnow_shape_kind kind;
  union {
    struct {
      double radius;
    } sphere;
    struct {
      double radius;
      double half_length;
    } capsule;
    struct {
      double half[3];
      double rounding;
    } box;
    struct {
      double radius;
      double half_length;
      double rounding;
    } cylinder;
    struct {
      double radius;
      double half_length;
      double rounding;
    } cone;
    struct {
      double vertex[3][3];
      double rounding;
    } triangle;
    struct {
      double normal[3];
      double offset;
    } half_space;
    struct {
      double radius[3];
      double rounding;
    } ellipsoid;
    struct {
      double radius[2];
      double half_length;
    } tapered_capsule;
    struct {
      winnow_support_function function;
      const void* context;
      double radius;
      double rounding;
    } support;
    double reserved[16];
  } as;
} winnow_shape;

typedef struct winnow_shape_pool winnow_shape_pool;
WINNOW_C_API winnow_status winnow_shape_pool_create(const winnow_memory* memory,
                                                    winnow_shape_pool** pool);
WINNOW_C_API void winnow_shape_pool_destroy(winnow_shape_pool* pool);
WINNOW_C_API winnow_status winnow_shape_pool_add(winnow_shape_pool* pool, const winnow_shape* shape,
                                                 winnow_shape_id* id);
WINNOW_C_API winnow_status winnow_shape_pool_add_hull(winnow_shape_pool* pool,
                                                      const winnow_point_view* points,
                                                      double rounding, winnow_shape_id* id);

/// Face i consists of the next `sizes[i]` entries of `indices`: indices into the points,
/// counter-clockwise seen from outside.
typedef struct winnow_hull_faces {
  const uint32_t* indices;
  size_t index_count;
  const uint32_t* sizes;
  size_t face_count;
} winnow_hull_faces;
WINNOW_C_API winnow_status winnow_shape_pool_add_hull_faces(winnow_shape_pool* pool,
                                                            const winnow_point_view* points,
                                                            const winnow_hull_faces* faces,
                                                            double rounding, winnow_shape_id* id);
WINNOW_C_API winnow_status winnow_shape_pool_remove(winnow_shape_pool* pool, winnow_shape_id id);
WINNOW_C_API winnow_status winnow_shape_pool_contains(const winnow_shape_pool* pool,
                                                      winnow_shape_id id, bool* contains);
WINNOW_C_API winnow_status winnow_shape_pool_size(const winnow_shape_pool* pool,
                                                  winnow_shape_kind kind, size_t* size);
/// Returns WINNOW_INVALID_KEY or WINNOW_INVALID_POSE where the C++ function requires valid
/// arguments.
WINNOW_C_API winnow_status winnow_shape_pool_bounds(const winnow_shape_pool* pool,
                                                    winnow_shape_id id, const winnow_pose* pose,
                                                    winnow_aabb* box);
/// Returns the shape as it was added; the normal of a half-space is normalised. WINNOW_INVALID_KEY
/// for a hull.
WINNOW_C_API winnow_status winnow_shape_pool_shape(const winnow_shape_pool* pool,
                                                   winnow_shape_id id, winnow_shape* shape);

typedef struct winnow_hull_face {
  double normal[3];
  double offset;
  uint32_t first;  ///< the vertices are loop[first] to loop[first + count - 1]
  uint32_t count;
} winnow_hull_face;

/// A hull as the pool stores it; valid until the pool is changed.
typedef struct winnow_hull {
  size_t size;  ///< set by the caller to sizeof(winnow_hull)
  size_t vertices;
  size_t faces;
  uint32_t dimension;
  double rounding;
  double center[3];
  double radius;
  const double* vertex[3];
  const winnow_hull_face* face;
  const uint32_t* loop;
} winnow_hull;
WINNOW_C_API winnow_status winnow_shape_pool_hull(const winnow_shape_pool* pool, winnow_shape_id id,
                                                  winnow_hull* hull);
WINNOW_C_API winnow_status winnow_shape_pool_footprint(const winnow_shape_pool* pool,
                                                       winnow_footprint* footprint);

/// The points origin + t * direction, 0 <= t <= max_t.
typedef struct winnow_shape_ray {
  double origin[3];
  double direction[3];
  double max_t;
} winnow_shape_ray;
#define WINNOW_SHAPE_RAY \
  { {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, INFINITY }

typedef struct winnow_shape_hit {
  bool hit;
  double t;
  double normal[3];
} winnow_shape_hit;
WINNOW_C_API winnow_status winnow_cast_ray(const winnow_shape_pool* pool, winnow_shape_id shape,
                                           const winnow_pose* pose, const winnow_shape_ray* ray,
                                           winnow_shape_hit* hit);

// --- composite shapes -----------------------------------------------------------------------

typedef struct winnow_composite_pool winnow_composite_pool;
/// `shapes` must outlive the pool.
WINNOW_C_API winnow_status winnow_composite_pool_create(const winnow_shape_pool* shapes,
                                                        const winnow_memory* memory,
                                                        winnow_composite_pool** pool);
WINNOW_C_API void winnow_composite_pool_destroy(winnow_composite_pool* pool);

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_mesh_options {
  size_t size;  ///< set by the caller to sizeof(winnow_mesh_options)
  /// 0 means 0.02. To make every edge that is not flat active, use the smallest double above 0.
  double active_edge_angle;
} winnow_mesh_options;
#define WINNOW_MESH_OPTIONS \
  { sizeof(winnow_mesh_options), 0.02 }

/// `options` and `execution` may be null.
WINNOW_C_API winnow_status winnow_composite_pool_add_mesh(winnow_composite_pool* pool,
                                                          const winnow_point_view* vertices,
                                                          const winnow_index_view* triangles,
                                                          const winnow_mesh_options* options,
                                                          const winnow_execution* execution,
                                                          winnow_shape_id* id);
WINNOW_C_API winnow_status winnow_composite_pool_add_scaled(winnow_composite_pool* pool,
                                                            winnow_shape_id mesh,
                                                            const double scale[3],
                                                            winnow_shape_id* id);
WINNOW_C_API winnow_status winnow_composite_pool_refit_mesh(winnow_composite_pool* pool,
                                                            winnow_shape_id mesh,
                                                            const winnow_point_view* vertices,
                                                            const winnow_execution* execution);

/// Sample (column, row) is heights[row * row_stride + column]. NaN is a hole.
typedef struct winnow_height_samples {
  const float* heights;
  size_t count;  ///< number of heights
  uint32_t columns;
  uint32_t rows;
  uint32_t row_stride;  ///< 0 means columns
  double spacing[2];
} winnow_height_samples;
#define WINNOW_HEIGHT_SAMPLES \
  {                           \
    NULL, 0, 0, 0, 0, {       \
      1.0, 1.0                \
    }                         \
  }
WINNOW_C_API winnow_status winnow_composite_pool_add_height_field(
    winnow_composite_pool* pool, const winnow_height_samples* samples, winnow_shape_id* id);
WINNOW_C_API winnow_status winnow_composite_pool_update_height_field(
    winnow_composite_pool* pool, winnow_shape_id field, uint32_t column, uint32_t row,
    const winnow_height_samples* samples);

/// A convex shape, a mesh or a height field, with its pose in the frame of the compound.
typedef struct winnow_compound_child {
  winnow_shape_id shape;
  winnow_pose pose;
} winnow_compound_child;
#define WINNOW_COMPOUND_CHILD \
  {                           \
    WINNOW_NO_SHAPE, {        \
      {0.0, 0.0, 0.0}, {      \
        1.0, 0.0, 0.0, 0.0    \
      }                       \
    }                         \
  }
WINNOW_C_API winnow_status winnow_composite_pool_add_compound(winnow_composite_pool* pool,
                                                              const winnow_compound_child* children,
                                                              size_t count, winnow_shape_id* id);
WINNOW_C_API winnow_status winnow_composite_pool_remove(winnow_composite_pool* pool,
                                                        winnow_shape_id id);
WINNOW_C_API winnow_status winnow_composite_pool_contains(const winnow_composite_pool* pool,
                                                          winnow_shape_id id, bool* contains);
WINNOW_C_API winnow_status winnow_composite_pool_size(const winnow_composite_pool* pool,
                                                      winnow_shape_kind kind, size_t* size);
WINNOW_C_API winnow_status winnow_composite_pool_bounds(const winnow_composite_pool* pool,
                                                        winnow_shape_id id, const winnow_pose* pose,
                                                        winnow_aabb* box);
WINNOW_C_API winnow_status winnow_composite_pool_radius(const winnow_composite_pool* pool,
                                                        winnow_shape_id id, double* radius);
/// Returns the number of parts; parts are numbered from 0. A mesh or height field has one part per
/// triangle. The parts of a compound are numbered child by child: one part per convex child, one
/// per triangle of a mesh or height field.
WINNOW_C_API winnow_status winnow_composite_pool_parts(const winnow_composite_pool* pool,
                                                       winnow_shape_id id, size_t* parts);
/// Returns the child that a part of a compound belongs to, and the triangle of that child;
/// WINNOW_WHOLE_SHAPE as the triangle if the child is convex. Returns WINNOW_INVALID_KEY if the
/// compound or the part does not exist.
WINNOW_C_API winnow_status winnow_composite_pool_part(const winnow_composite_pool* pool,
                                                      winnow_shape_id compound, uint32_t part,
                                                      uint32_t* child, uint32_t* child_part);
/// Makes a mesh solid, or a surface again. Distances and overlaps of scene queries treat the inside
/// of a solid as part of it. WINNOW_INVALID_SHAPE if the mesh is not closed, or its triangles are
/// not counter-clockwise seen from outside.
WINNOW_C_API winnow_status winnow_composite_pool_set_solid(winnow_composite_pool* pool,
                                                           winnow_shape_id mesh, bool solid);
WINNOW_C_API winnow_status winnow_composite_pool_is_solid(const winnow_composite_pool* pool,
                                                          winnow_shape_id mesh, bool* solid);
/// Returns the children of a compound; valid until the pool is changed.
WINNOW_C_API winnow_status winnow_composite_pool_children(const winnow_composite_pool* pool,
                                                          winnow_shape_id id,
                                                          const winnow_compound_child** children,
                                                          size_t* count);
WINNOW_C_API winnow_status winnow_composite_pool_footprint(const winnow_composite_pool* pool,
                                                           winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
