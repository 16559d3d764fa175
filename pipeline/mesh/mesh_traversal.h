#pragma once

// The interface to a mesh's tree: traversals that mesh_traversal.cpp prepares as jobs and that the
// kernels in the *.wide.h files of this folder run. composites/ calls these functions. Rays are in
// mesh_rays.kernel.h.

#include <winnow/pipeline/shapes.h>
#include "pipeline/mesh/mesh_view.h"
#include "simd/kernels/kernels.h"

namespace winnow {

// Traversals of a mesh's tree, in the mesh's own unscaled frame. They miss no triangle, and may
// report some triangles that do not match. Scratch is on the stack: at most about 90 KB for pairs,
// 40 KB for rays, and 3 KB for other traversals. Single-threaded; the output is equal on all
// instruction sets.

/// Finds the slots of all triangles whose boxes overlap [min, max], ascending. Bounds may be
/// infinite.
void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  SlotSink& out) noexcept;

/// A hull placed relative to a mesh.
struct MeshHull {
  const HullShape& shape;
  /// Transform from the mesh's frame to the hull's.
  MeshPlacement mesh_in_hull;
  /// In lengths of the hull: triangles up to this distance from its core are included.
  double reach;
};

/// As above, without triangles whose closest point to `center` is farther than `radius`. Triangles
/// that are farther by less than the rounding of float coordinates may remain, and slivers that are
/// farther by more. If the radius is not in [1e-30, 1e30), or a coordinate of the centre is 1e30 or
/// more, the ball excludes no triangle. A hull, which the ball must contain, is used in place of
/// the ball: the call finds the triangles within its reach; others remain only if no face of the
/// hull separates them, nor the direction from their closest point to the centre of the hull, or if
/// they extend beyond about 1e6 radii of the hull. If the hull is too far from the mesh or from its
/// own origin for floats, or too large or too small, the ball is used.
void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  const double center[3], double radius, const MeshHull* hull,
                  SlotSink& out) noexcept;

/// Finds the slots of triangles that may contain a point with normal . x <= offset, ascending.
void mesh_below(const MeshView& mesh, const double normal[3], double offset,
                SlotSink& out) noexcept;

/// Finds pairs (slot of a, slot of b) of triangles that may overlap once b is placed in the frame
/// of a and grown by `margin[k]` to both sides on axis k of that frame: pairs that neither their
/// boxes nor one of the two triangle planes separates. Each pair is reported once.
void mesh_overlap_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                        const double margin[3], SlotPairSink& out) noexcept;

/// Passes to the visitor pairs of triangles that may be no farther apart than `limit`, in lengths
/// of a, once b is placed in the frame of a. `error_bound[k]` bounds the error of b's position on
/// axis k. A negative limit ends the traversal.
void mesh_near_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                     const double error_bound[3], double limit,
                     const SlotPairVisitor& visitor) noexcept;

// The traversals below call the visitor with slots of one leaf at a time, nearest first. The limit
// that the visitor returns replaces the old one; a negative limit ends the traversal.

/// Visits slots of triangles whose boxes the moving box [min, max] + t * direction may overlap at
/// some t in [0, limit], roughly in order of t.
void mesh_cast(const MeshView& mesh, const double min[3], const double max[3],
               const double direction[3], double limit, const SlotVisitor& visitor) noexcept;

/// Visits slots of triangles that, multiplied by `scale` along the axes, may be within `limit` of
/// [min, max] (in scaled coordinates), roughly nearest first, one at a time. A triangle without
/// area may stand for the box of another object, so the distance of its box counts.
void mesh_near(const MeshView& mesh, const double scale[3], const double min[3],
               const double max[3], double limit, const SlotVisitor& visitor) noexcept;

// Parameters of the kernels; only plain structs.

/// A ball for the overlap test. Coordinates relative to its centre are multiplied by `scale`, a
/// power of two that makes the radius about 1.
struct MeshBallJob {
  float center[3];
  float scale;
  /// Scaled radius, and the largest scaled coordinate of the centre.
  float radius;
  float largest;
};

/// A hull for the overlap test; `shape` is null if there is none. Corners x of triangles are
/// transformed to matrix (x - middle) + offset: the hull's frame, relative to its centre, scaled by
/// a power of two that makes the hull's radius about 1.
struct MeshHullJob {
  const HullShape* shape;
  float middle[3];
  float matrix[3][3];
  float offset[3];
  /// The hull's centre in the hull's frame, unscaled.
  float center[3];
  float scale;
  /// Scaled: the reach, and the largest coordinate of the vertices.
  float reach;
  float largest;
};

/// The box of the overlap test: in node units, and rounded inward to floats. Float corners compare
/// with these floats as they compare with the box in double.
struct MeshBoxJob {
  float node_low[3];
  float node_high[3];
  float low[3];
  float high[3];
  bool has_ball;
  MeshBallJob ball;
  MeshHullJob hull;
};

/// Mesh b placed in the frame of mesh a. If coordinates on an axis may leave the range in which
/// doubles are reliable, the matrix row of this axis is zero and its slack infinite, so that
/// nothing is separated on it.
struct MeshPairJob {
  double matrix[3][3];
  double offset[3];
  /// The amount by which b is grown: the margin plus the rounding of its placement.
  double slack[3];
  /// A power of two that scales the corners of a to about 1, so that products of three lengths stay
  /// in the range of float; and the slack in that scale.
  float scale;
  float scaled_slack[3];
};

/// A box that moves by t * direction. On static axes it does not move, or by so little that [min,
/// max] is grown by the whole movement instead.
struct MeshCastJob {
  double min[3];
  double max[3];
  double inverse[3];
  double direction[3];
  bool is_static[3];
};

/// A box to measure distances from, and the factors by which the mesh is scaled.
struct MeshNearJob {
  double min[3];
  double max[3];
  double scale[3];
};

struct MeshKernels {
  void (*overlap)(const MeshView& mesh, const MeshBoxJob& job, SlotSink& out);
  void (*pairs)(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out);
  void (*cast)(const MeshView& mesh, const MeshCastJob& job, double limit,
               const SlotVisitor& visitor);
  void (*near_pairs)(const MeshView& a, const MeshView& b, const MeshPairJob& job, double limit,
                     const SlotPairVisitor& visitor);
  void (*near)(const MeshView& mesh, const MeshNearJob& job, double limit,
               const SlotVisitor& visitor);
};

WINNOW_KERNELS(MeshKernels, mesh_kernels);

}  // namespace winnow
