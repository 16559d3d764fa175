// Generated from pipeline/interface/shapes.toml; do not edit.
// clang-format off
#pragma once

/// Convex shapes, and composite shapes made of them or of triangles. Bodies refer to shapes by id
/// and may share them. Lengths are in the units of the world.

#include <winnow/c/core.h>
#include <winnow/c/volumes.h>
#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The convex shapes of a simulation. While a thread changes a pool, no other thread may use it.
typedef struct winnow_shape_pool winnow_shape_pool;

/// Triangle meshes, height fields, and compounds of convex shapes and of these surfaces.
typedef struct winnow_composite_pool winnow_composite_pool;

/// Id of no shape.
#define WINNOW_NO_SHAPE 0xFFFFFFFFU

/// Part number of a convex shape, which has no parts.
#define WINNOW_WHOLE_SHAPE 0xFFFFFFFFU

/// Kinds of shapes of both pools.
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
  WINNOW_SHAPE_SUPPORT = 13  ///< a user shape, given by a support function
};

/// Id of a shape of either pool: its kind (upper four bits) and its index among shapes of that
/// kind.
typedef uint32_t winnow_shape_id;

/// Support function of a user shape: writes the point of the shape that is farthest along
/// `direction`. Both are arrays of three numbers.
typedef void (*winnow_support_function)(const void* context, const double* direction,
                                        double* point);

/// A convex shape other than a hull. C++ documents the kinds in <winnow/pipeline/shapes.h>; lengths
/// are finite and >= 0.
typedef struct winnow_shape {
  winnow_shape_kind kind;  ///< determines the member of `as`
  /// Rounding is a distance by which the surface is moved outward.
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

/// Surface of a hull. Face i consists of the next `sizes[i]` entries of `indices`: indices into the
/// points, counter-clockwise seen from outside. Coplanar faces may be given as several triangles.
typedef struct winnow_hull_faces {
  const uint32_t* indices;  ///< indices of points, face after face
  size_t index_count;       ///< number of indices
  const uint32_t* sizes;    ///< number of vertices of each face, 3 or more
  size_t face_count;        ///< number of faces
} winnow_hull_faces;

/// A face of a hull that a pool contains.
typedef struct winnow_hull_face {
  double normal[3];  ///< unit, outward
  double offset;     ///< distance of the plane from the origin
  uint32_t first;    ///< the vertices are loop[first] to loop[first + count - 1]
  uint32_t count;    ///< number of vertices
} winnow_hull_face;

/// A hull as the pool stores it; valid until the pool is changed.
typedef struct winnow_hull {
  size_t size;                   ///< set by the caller to sizeof(winnow_hull)
  size_t vertices;               ///< number of vertices
  size_t faces;                  ///< number of faces
  uint32_t dimension;            ///< 0 for a point, 1 for a segment, 2 for a polygon, 3
  double rounding;               ///< distance by which the surface is moved outward
  double center[3];              ///< centre of a ball that contains the hull
  double radius;                 ///< of this ball
  const double* vertex[3];       ///< x, y, z of the vertices
  const winnow_hull_face* face;  ///< the faces
  const uint32_t* loop;          ///< vertices of all faces
} winnow_hull;

/// The points origin + t * direction, min_t <= t <= max_t.
typedef struct winnow_shape_ray {
  double origin[3];     ///< finite
  double direction[3];  ///< of any length but 0
  double min_t;         ///< finite, >= 0
  double max_t;         ///< >= min_t; may be infinite
} winnow_shape_ray;
#define WINNOW_SHAPE_RAY {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.0, INFINITY}

/// Entry of a ray into a shape.
typedef struct winnow_shape_hit {
  bool hit;          ///< false if the ray does not hit the shape; the other members are then 0
  double t;          ///< the smallest t at which the ray is inside the shape; 0 if it starts inside
  double normal[3];  ///< outward unit normal, against the ray
} winnow_shape_hit;

/// Options of building a mesh. A null pointer, or zero members after `size`, mean the defaults of
/// C++.
typedef struct winnow_mesh_options {
  size_t size;  ///< set by the caller to sizeof(winnow_mesh_options)
  /// Angle in radians above which a convex edge of a mesh in a compound is active: it has contacts
  /// along its own normals, even if only one of its triangles touches. 0 means 0.02. To make every
  /// edge that is not flat active, use the smallest double above 0.
  double active_edge_angle;
} winnow_mesh_options;
#define WINNOW_MESH_OPTIONS {sizeof(winnow_mesh_options), 0.02}

/// Heights: sample (column, row) is heights[row * row_stride + column]. NaN is a hole.
typedef struct winnow_height_samples {
  const float* heights;  ///< the samples
  size_t count;          ///< number of heights
  uint32_t columns;      ///< samples along x, 2 or more
  uint32_t rows;         ///< samples along y, 2 or more
  uint32_t row_stride;   ///< 0 means columns
  double spacing[2];     ///< along x and y; positive, finite
} winnow_height_samples;
#define WINNOW_HEIGHT_SAMPLES {NULL, 0, 0, 0, 0, {1.0, 1.0}}

/// A convex shape, a mesh or a height field, with its pose in the frame of the compound.
typedef struct winnow_compound_child {
  winnow_shape_id shape;  ///< from one of the two pools
  winnow_pose pose;       ///< in the frame of the compound
} winnow_compound_child;
#define WINNOW_COMPOUND_CHILD {WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}}

/// Creates an empty pool.
WINNOW_C_API winnow_status winnow_shape_pool_create(
    const winnow_memory* memory, winnow_shape_pool** pool);

/// Destroys the shape pool; does nothing for null.
WINNOW_C_API void winnow_shape_pool_destroy(winnow_shape_pool* pool);

/// Adds a shape other than a hull. WINNOW_INVALID_SHAPE for a length that is negative, NaN or
/// infinite, a half-space without a normal, or a user shape that is not convex;
/// WINNOW_TOO_MANY_OBJECTS beyond 2^28 shapes of a kind. O(1).
WINNOW_C_API winnow_status winnow_shape_pool_add(
    winnow_shape_pool* pool, const winnow_shape* shape, winnow_shape_id* id);

/// Adds the convex hull of points, computed without rounding. A flat set becomes a polygon, a
/// segment or a point. WINNOW_INVALID_SHAPE if there is no point or one is not finite.
WINNOW_C_API winnow_status winnow_shape_pool_add_hull(
    winnow_shape_pool* pool, const winnow_point_view* points, double rounding, winnow_shape_id* id);

/// Adds the hull bounded by `faces`. WINNOW_INVALID_SHAPE unless they are closed, consistently
/// oriented and convex to 1e-9 of the hull's size.
WINNOW_C_API winnow_status winnow_shape_pool_add_hull_faces(
    winnow_shape_pool* pool, const winnow_point_view* points, const winnow_hull_faces* faces,
    double rounding, winnow_shape_id* id);

/// Adds a hull that was read from a pool, given by its vertices and its faces in order; the pool
/// stores it bit for bit. Without faces: a segment or a point. WINNOW_INVALID_SHAPE if no pool can
/// contain such a hull.
WINNOW_C_API winnow_status winnow_shape_pool_add_built_hull(
    winnow_shape_pool* pool, const winnow_point_view* points, const winnow_hull_faces* faces,
    double rounding, winnow_shape_id* id);

/// Removes a shape. Bodies must not use its id any more: a later shape of the same kind gets its
/// index.
WINNOW_C_API winnow_status winnow_shape_pool_remove(winnow_shape_pool* pool, winnow_shape_id id);

/// Returns whether the pool contains the shape.
WINNOW_C_API winnow_status winnow_shape_pool_contains(
    const winnow_shape_pool* pool, winnow_shape_id id, bool* contains);

/// Returns the number of shapes of a kind. WINNOW_INVALID_ARGUMENT for a composite kind.
WINNOW_C_API winnow_status winnow_shape_pool_size(
    const winnow_shape_pool* pool, winnow_shape_kind kind, size_t* size);

/// Writes a float box that contains the shape at the pose, rounded outward. WINNOW_INVALID_KEY if
/// the pool does not contain the shape; WINNOW_INVALID_POSE.
WINNOW_C_API winnow_status winnow_shape_pool_bounds(
    const winnow_shape_pool* pool, winnow_shape_id id, const winnow_pose* pose, winnow_aabb* box);

/// Writes the shape as it was added; the normal of a half-space is normalised. WINNOW_INVALID_KEY
/// for a hull, or if the pool does not contain the shape.
WINNOW_C_API winnow_status winnow_shape_pool_shape(
    const winnow_shape_pool* pool, winnow_shape_id id, winnow_shape* shape);

/// Writes a hull. WINNOW_INVALID_KEY if the shape is none.
WINNOW_C_API winnow_status winnow_shape_pool_hull(
    const winnow_shape_pool* pool, winnow_shape_id id, winnow_hull* hull);

/// Writes the bytes of the shape pool, by purpose.
WINNOW_C_API winnow_status winnow_shape_pool_footprint(
    const winnow_shape_pool* pool, winnow_footprint* footprint);

/// Creates an empty pool. `shapes` contains the convex children of compounds and must outlive the
/// pool.
WINNOW_C_API winnow_status winnow_composite_pool_create(
    const winnow_shape_pool* shapes, const winnow_memory* memory, winnow_composite_pool** pool);

/// Destroys the composite pool; does nothing for null.
WINNOW_C_API void winnow_composite_pool_destroy(winnow_composite_pool* pool);

/// Copies vertices (rounded to float) and triangles, and builds a tree of boxes over them.
/// `execution` may be null. WINNOW_INVALID_SHAPE if there is no triangle, a vertex is not finite in
/// float, or a corner is not a vertex.
WINNOW_C_API winnow_status winnow_composite_pool_add_mesh(
    winnow_composite_pool* pool, const winnow_point_view* vertices,
    const winnow_index_view* triangles, const winnow_mesh_options* options,
    const winnow_execution* execution, winnow_shape_id* id);

/// Adds a scaled instance of a mesh: a new id that shares the triangles, multiplied by `scale`
/// along the axes of the mesh. Factors are finite and not zero; negative ones mirror.
WINNOW_C_API winnow_status winnow_composite_pool_add_scaled(
    winnow_composite_pool* pool, winnow_shape_id mesh, const double scale[3], winnow_shape_id* id);

/// Adds a mesh that winnow_composite_pool_save_mesh saved, with a scale. `execution` may be null.
/// WINNOW_INVALID_ARGUMENT if the bytes are not a valid mesh. O(bytes).
WINNOW_C_API winnow_status winnow_composite_pool_add_saved_mesh(
    winnow_composite_pool* pool, const uint8_t* bytes, size_t count, const double scale[3],
    const winnow_execution* execution, winnow_shape_id* id);

/// Adds a height field that winnow_composite_pool_save_height_field saved. WINNOW_INVALID_ARGUMENT
/// if the bytes are not a valid height field. O(bytes).
WINNOW_C_API winnow_status winnow_composite_pool_add_saved_height_field(
    winnow_composite_pool* pool, const uint8_t* bytes, size_t count, winnow_shape_id* id);

/// Moves the vertices of a mesh, for all its scaled instances, and refits the tree. `execution` may
/// be null. WINNOW_SIZE_MISMATCH for another number of vertices. O(n).
WINNOW_C_API winnow_status winnow_composite_pool_refit_mesh(
    winnow_composite_pool* pool, winnow_shape_id mesh, const winnow_point_view* vertices,
    const winnow_execution* execution);

/// Adds a height field. WINNOW_INVALID_SHAPE for fewer than 2 x 2 samples, an infinite height, or
/// an invalid spacing; WINNOW_SIZE_MISMATCH if there are too few heights.
WINNOW_C_API winnow_status winnow_composite_pool_add_height_field(
    winnow_composite_pool* pool, const winnow_height_samples* samples, winnow_shape_id* id);

/// Replaces the heights of the samples [column, column + samples.columns) x [row, row +
/// samples.rows). WINNOW_INVALID_ARGUMENT if they are not all in the field; WINNOW_INVALID_KEY if
/// the id is not of a height field.
WINNOW_C_API winnow_status winnow_composite_pool_update_height_field(
    winnow_composite_pool* pool, winnow_shape_id field, uint32_t column, uint32_t row,
    const winnow_height_samples* samples);

/// Adds a compound. Its convex children must stay in the shape pool while it exists, and its
/// surfaces cannot be removed. WINNOW_INVALID_SHAPE if there are no children; WINNOW_INVALID_KEY
/// for a child that neither pool contains or that is a compound; WINNOW_INVALID_POSE.
WINNOW_C_API winnow_status winnow_composite_pool_add_compound(
    winnow_composite_pool* pool, const winnow_compound_child* children, size_t count,
    winnow_shape_id* id);

/// Makes the triangles of a mesh or height field one-sided, or two-sided again (the default). The
/// front of a mesh triangle is the side from which its vertices run counter-clockwise; the front of
/// a height field is up. A one-sided triangle does not collide with an object whose centre is
/// behind it. WINNOW_INVALID_KEY if the id is not of a surface.
WINNOW_C_API winnow_status winnow_composite_pool_set_one_sided(
    winnow_composite_pool* pool, winnow_shape_id surface, bool one_sided);

/// Returns whether the triangles of this surface are one-sided.
WINNOW_C_API winnow_status winnow_composite_pool_is_one_sided(
    const winnow_composite_pool* pool, winnow_shape_id surface, bool* one_sided);

/// Makes a mesh solid, or a surface again. Distances and overlaps of scene queries treat the inside
/// of a solid as part of it. WINNOW_INVALID_SHAPE if the mesh is not closed, or its triangles are
/// not counter-clockwise seen from outside.
WINNOW_C_API winnow_status winnow_composite_pool_set_solid(
    winnow_composite_pool* pool, winnow_shape_id mesh, bool solid);

/// Returns whether this mesh is solid.
WINNOW_C_API winnow_status winnow_composite_pool_is_solid(
    const winnow_composite_pool* pool, winnow_shape_id mesh, bool* solid);

/// Removes a shape. Bodies must not use its id any more. WINNOW_INVALID_ARGUMENT for a surface that
/// is a child of a compound.
WINNOW_C_API winnow_status winnow_composite_pool_remove(
    winnow_composite_pool* pool, winnow_shape_id id);

/// Returns whether the pool contains the shape.
WINNOW_C_API winnow_status winnow_composite_pool_contains(
    const winnow_composite_pool* pool, winnow_shape_id id, bool* contains);

/// Returns the number of shapes of a composite kind; scaled instances of meshes count too.
WINNOW_C_API winnow_status winnow_composite_pool_size(
    const winnow_composite_pool* pool, winnow_shape_kind kind, size_t* size);

/// Writes the scale of a mesh along its axes; ones if the id is not of a mesh.
WINNOW_C_API winnow_status winnow_composite_pool_scale(
    const winnow_composite_pool* pool, winnow_shape_id mesh, double scale[3]);

/// Writes a float box that contains the shape at the pose, rounded outward. Errors as for shape
/// pools.
WINNOW_C_API winnow_status winnow_composite_pool_bounds(
    const winnow_composite_pool* pool, winnow_shape_id id, const winnow_pose* pose,
    winnow_aabb* box);

/// Returns an upper bound on the distance of the shape's points from the origin of its frame.
WINNOW_C_API winnow_status winnow_composite_pool_radius(
    const winnow_composite_pool* pool, winnow_shape_id id, double* radius);

/// Returns the number of parts; parts are numbered from 0. A mesh or height field has one part per
/// triangle. The parts of a compound are numbered child by child: one part per convex child, one
/// per triangle of a mesh or height field.
WINNOW_C_API winnow_status winnow_composite_pool_parts(
    const winnow_composite_pool* pool, winnow_shape_id id, size_t* parts);

/// Returns the child that a part of a compound belongs to, and the triangle of that child;
/// WINNOW_WHOLE_SHAPE as the triangle if the child is convex. WINNOW_INVALID_KEY if the compound or
/// the part does not exist.
WINNOW_C_API winnow_status winnow_composite_pool_part(
    const winnow_composite_pool* pool, winnow_shape_id compound, uint32_t part, uint32_t* child,
    uint32_t* child_part);

/// Returns the children of a compound; valid until the pool is changed.
WINNOW_C_API winnow_status winnow_composite_pool_children(
    const winnow_composite_pool* pool, winnow_shape_id id, const winnow_compound_child** children,
    size_t* count);

/// Returns a counter that grows when a shape is changed in place (refit) or removed. Cached data
/// about pairs of composite shapes are then invalid.
WINNOW_C_API winnow_status winnow_composite_pool_revision(
    const winnow_composite_pool* pool, uint64_t* revision);

/// Writes the bytes of the composite pool, by purpose.
WINNOW_C_API winnow_status winnow_composite_pool_footprint(
    const winnow_composite_pool* pool, winnow_footprint* footprint);

/// Returns the name of a kind, such as "sphere"; "none" if it is invalid.
WINNOW_C_API const char* winnow_shape_kind_name(winnow_shape_kind kind);

/// Finds the point at which a ray enters a shape. Shapes are closed sets; triangles are two-sided.
/// WINNOW_INVALID_ARGUMENT for an invalid ray; WINNOW_INVALID_KEY; WINNOW_INVALID_POSE.
WINNOW_C_API winnow_status winnow_cast_ray(
    const winnow_shape_pool* pool, winnow_shape_id shape, const winnow_pose* pose,
    const winnow_shape_ray* ray, winnow_shape_hit* hit);

#ifdef __cplusplus
}
#endif
