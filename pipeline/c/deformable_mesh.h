// Generated from pipeline/interface/deformable_mesh.toml; do not edit.
// clang-format off
#pragma once

/// Cloth and soft bodies: certified impacts and proximity of meshes whose vertices move in every
/// step. Pairs of features are (vertex, face) or (edge, edge), within a mesh or with another mesh;
/// features that share a vertex are not paired.

#include <winnow/c/core.h>
#include <winnow/c/partition.h>
#include <winnow/c/shapes.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A mesh whose vertices stay in the caller's memory: they are read by every call until the next
/// winnow_deformable_mesh_move. After the first step only results are allocated, at most one chunk
/// at a time. Results come in chunks, through a callback; their order is the same for any number of
/// threads and any instruction set.
typedef struct winnow_deformable_mesh winnow_deformable_mesh;

/// Kinds of feature pairs of meshes, each given by four points.
typedef int32_t winnow_feature_pair;
enum {
  WINNOW_FEATURES_VERTEX_FACE = 0,  ///< point 0 and the triangle of points 1, 2 and 3
  WINNOW_FEATURES_EDGE_EDGE = 1     ///< the edge from point 0 to 1 and the edge from point 2 to 3
};

/// Options of a deformable mesh. A null pointer, or zero members after `size`, mean the defaults of
/// C++.
typedef struct winnow_deformable_mesh_options {
  size_t size;                  ///< set by the caller to sizeof(winnow_deformable_mesh_options)
  const winnow_memory* memory;  ///< source of every allocation; null means the default memory
  winnow_execution execution;   ///< how boxes are updated and candidates are tested in parallel
  /// Of the float boxes: a point near the mesh; equal for meshes that are tested together.
  double origin[3];
  size_t chunk;  ///< largest number of results per callback; 0 means 16384
} winnow_deformable_mesh_options;
#define WINNOW_DEFORMABLE_MESH_OPTIONS \
  {sizeof(winnow_deformable_mesh_options), NULL, {0, {NULL, NULL, 0}}, {0.0, 0.0, 0.0}, 16384}

/// When features count as touching, and the limit of work. A null pointer, or zero members after
/// `size`, mean the defaults of C++.
typedef struct winnow_feature_impact_options {
  size_t size;            ///< set by the caller to sizeof(winnow_feature_impact_options)
  double min_separation;  ///< distance at which features touch: finite, >= 0
  double tolerance;  ///< how early the time may be before the first touch, in (0, 1]; 0 means 2^-40
  uint32_t max_intervals;  ///< largest number of time intervals to examine; 0 means 2048
} winnow_feature_impact_options;
#define WINNOW_FEATURE_IMPACT_OPTIONS \
  {sizeof(winnow_feature_impact_options), 0.0, 9.094947017729282e-13, 2048}

/// Two features of meshes that touch during the step.
typedef struct winnow_mesh_impact {
  winnow_pair features;  ///< a vertex and a face, or two edges; of one mesh: the lower one first
  double time;           ///< of the first touch, never late
} winnow_mesh_impact;

/// Two features of meshes whose distance at the end of the step is at most the given thickness.
typedef struct winnow_mesh_proximity {
  winnow_pair features;  ///< see winnow_mesh_impact
  double distance;       ///< exact to a few rounding errors of the vertices
  double point[2][3];    ///< closest points, on the first and the second feature
  /// Barycentric weights of the points: weight[0] of the vertex, or weight[0] and weight[1] of the
  /// ends of the edge; the remaining ones of the corners of the face, or of the ends of the second
  /// edge.
  double weight[4];
} winnow_mesh_proximity;

/// A rigid shape of any kind, and its motion during the step, to be tested against meshes.
typedef struct winnow_mesh_obstacle {
  const winnow_shape_pool* shapes;  ///< contains the shape, or its convex parts
  winnow_shape_id shape;            ///< the shape
  winnow_rigid_motion motion;       ///< its motion during the step
  /// Gap at which a face touches the shape: finite, >= 0, at most half of the distance given to
  /// move.
  double separation;
} winnow_mesh_obstacle;
#define WINNOW_MESH_OBSTACLE \
  {NULL, WINNOW_NO_SHAPE, {{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}, {0.0, 0.0, \
  0.0}}, 0.0}

/// A face of a mesh and a rigid shape that touch during the step.
typedef struct winnow_mesh_shape_impact {
  uint32_t face;       ///< number of the face
  uint32_t part;       ///< triangle or child of the shape; WINNOW_WHOLE_SHAPE for a convex shape
  double time;         ///< in [0, 1], never late
  double gap;          ///< at that time, beyond the separation
  double error_bound;  ///< the true gap is within gap +- error_bound
  double normal[3];    ///< unit vector from the shape to the face, at that time
  double point[3];     ///< contact point on the shape at that time, in the world
} winnow_mesh_shape_impact;

/// Result for one pair of features.
typedef struct winnow_feature_hit {
  bool hit;     ///< false: they do not touch in [0, 1]
  double time;  ///< of the first touch, never late; infinite if there is none
} winnow_feature_hit;

/// Many pairs of features: coordinate `axis` of point k of pair i at the start is
/// start[k][axis][i].
typedef struct winnow_feature_columns {
  const double* start[4][3];  ///< at time 0
  const double* end[4][3];    ///< at time 1
  size_t count;               ///< number of pairs
} winnow_feature_columns;

/// Receives chunks of pairs. The array is valid only during the call.
typedef struct winnow_pair_chunks {
  void (*take)(void* context, const winnow_pair* pairs, size_t count);  ///< must not be null
  void* context;                                                        ///< passed to `take`
} winnow_pair_chunks;

/// Receives chunks of impacts. The array is valid only during the call.
typedef struct winnow_mesh_impact_chunks {
  /// Must not be null.
  void (*take)(void* context, const winnow_mesh_impact* impacts, size_t count);
  void* context;  ///< passed to `take`
} winnow_mesh_impact_chunks;

/// Receives chunks of close features. The array is valid only during the call.
typedef struct winnow_mesh_proximity_chunks {
  /// Must not be null.
  void (*take)(void* context, const winnow_mesh_proximity* pairs, size_t count);
  void* context;  ///< passed to `take`
} winnow_mesh_proximity_chunks;

/// Receives chunks of impacts with a shape. The array is valid only during the call.
typedef struct winnow_mesh_shape_impact_chunks {
  /// Must not be null.
  void (*take)(void* context, const winnow_mesh_shape_impact* impacts, size_t count);
  void* context;  ///< passed to `take`
} winnow_mesh_shape_impact_chunks;

/// Creates a mesh without triangles.
WINNOW_C_API winnow_status winnow_deformable_mesh_create(
    const winnow_deformable_mesh_options* options, winnow_deformable_mesh** mesh);

/// Destroys the deformable mesh; does nothing for null.
WINNOW_C_API void winnow_deformable_mesh_destroy(winnow_deformable_mesh* mesh);

/// Copies the triangles and sorts them by the rest positions of their vertices. Calling it again
/// replaces the mesh. WINNOW_INVALID_SHAPE if there is no triangle or a corner is not a vertex;
/// WINNOW_INVALID_BOUNDS if a coordinate is not finite; WINNOW_TOO_MANY_OBJECTS beyond 2^28
/// triangles or 2^31 - 1 vertices. O(n log n).
WINNOW_C_API winnow_status winnow_deformable_mesh_build(
    winnow_deformable_mesh* mesh, const winnow_point_view* rest,
    const winnow_index_view* triangles);

/// Sets the step: every vertex moves linearly from its position in `start` to its position in
/// `end`, which may be the same view. Candidates are all features that come within `distance` of
/// each other, such as a separation or a thickness. The columns must stay in memory until the next
/// call. WINNOW_SIZE_MISMATCH for another number of vertices; WINNOW_INVALID_BOUNDS;
/// WINNOW_INVALID_ARGUMENT if `distance` is negative or not finite, or before `build`. O(n).
WINNOW_C_API winnow_status winnow_deformable_mesh_move(
    winnow_deformable_mesh* mesh, const winnow_point_view* start, const winnow_point_view* end,
    double distance);

/// Returns the number of triangles; 0 before `build`.
WINNOW_C_API winnow_status winnow_deformable_mesh_triangles(
    const winnow_deformable_mesh* mesh, size_t* count);

/// Returns the number of vertices; 0 before `build`.
WINNOW_C_API winnow_status winnow_deformable_mesh_vertices(
    const winnow_deformable_mesh* mesh, size_t* count);

/// Returns the number of edges, each counted once.
WINNOW_C_API winnow_status winnow_deformable_mesh_edges(
    const winnow_deformable_mesh* mesh, size_t* count);

/// Writes the vertices of an edge, the lower one first. Edges are sorted by their vertices.
WINNOW_C_API winnow_status winnow_deformable_mesh_edge(
    const winnow_deformable_mesh* mesh, size_t i, uint32_t vertices[2]);

/// Finds all pairs of features whose boxes overlap, each once: (vertex, face), or (edge, edge) with
/// the lower one first. WINNOW_INVALID_ARGUMENT before the first move; WINNOW_OUT_OF_MEMORY if a
/// chunk cannot be allocated.
WINNOW_C_API winnow_status winnow_deformable_mesh_self_candidates(
    const winnow_deformable_mesh* mesh, winnow_feature_pair kind, const winnow_pair_chunks* chunks);

/// As above, for pairs of a feature of this mesh (first) and one of another mesh.
/// WINNOW_INVALID_ARGUMENT also if the origins differ.
WINNOW_C_API winnow_status winnow_deformable_mesh_candidates_with(
    const winnow_deformable_mesh* mesh, const winnow_deformable_mesh* other,
    winnow_feature_pair kind, const winnow_pair_chunks* chunks);

/// Finds all candidates that touch during the step. WINNOW_INVALID_ARGUMENT also for invalid
/// options or a separation that exceeds the distance given to the move.
WINNOW_C_API winnow_status winnow_deformable_mesh_self_impacts(
    const winnow_deformable_mesh* mesh, winnow_feature_pair kind,
    const winnow_feature_impact_options* options, const winnow_mesh_impact_chunks* chunks);

/// As above, with another mesh. The separation is at most half the sum of the distances given to
/// the moves of the two meshes.
WINNOW_C_API winnow_status winnow_deformable_mesh_impacts_with(
    const winnow_deformable_mesh* mesh, const winnow_deformable_mesh* other,
    winnow_feature_pair kind, const winnow_feature_impact_options* options,
    const winnow_mesh_impact_chunks* chunks);

/// Finds all faces that a rigid shape touches during the step, each with its first impact. The
/// mesh's own execution is used. WINNOW_INVALID_KEY if the shape does not exist; WINNOW_UNSUPPORTED
/// for a composite shape without a pool of them; WINNOW_INVALID_POSE for an invalid motion.
WINNOW_C_API winnow_status winnow_deformable_mesh_impacts_with_shape(
    const winnow_deformable_mesh* mesh, const winnow_mesh_obstacle* obstacle,
    const winnow_impact_options* options, const winnow_mesh_shape_impact_chunks* chunks);

/// Finds all pairs whose distance at the end of the step is at most `thickness`.
/// WINNOW_INVALID_ARGUMENT also if it is negative, not finite, or exceeds the distance given to the
/// move.
WINNOW_C_API winnow_status winnow_deformable_mesh_self_proximity(
    const winnow_deformable_mesh* mesh, winnow_feature_pair kind, double thickness,
    const winnow_mesh_proximity_chunks* chunks);

/// As above, with another mesh. The thickness is at most half the sum of the distances given to the
/// moves of the two meshes.
WINNOW_C_API winnow_status winnow_deformable_mesh_proximity_with(
    const winnow_deformable_mesh* mesh, const winnow_deformable_mesh* other,
    winnow_feature_pair kind, double thickness, const winnow_mesh_proximity_chunks* chunks);

/// Writes the bytes of the deformable mesh, by purpose.
WINNOW_C_API winnow_status winnow_deformable_mesh_footprint(
    const winnow_deformable_mesh* mesh, winnow_footprint* footprint);

/// Finds the time at which two features first touch, while each of their four points (x, y, z one
/// after the other) moves linearly from `start` at time 0 to `end` at time 1. No touch is missed
/// and no time is late. WINNOW_INVALID_BOUNDS if a coordinate is not finite or a difference of two
/// overflows.
WINNOW_C_API winnow_status winnow_feature_impact(
    winnow_feature_pair kind, const double start[12], const double end[12],
    const winnow_feature_impact_options* options, winnow_feature_hit* hit);

/// As above, for many pairs: times[i] is the time of pair i, infinite if there is no impact, NaN if
/// its coordinates are invalid.
WINNOW_C_API winnow_status winnow_feature_impacts(
    winnow_feature_pair kind, const winnow_feature_columns* pairs, double* times,
    const winnow_feature_impact_options* options);

#ifdef __cplusplus
}
#endif
