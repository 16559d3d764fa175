#pragma once

#include <winnow/pipeline/shapes.h>
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/mesh/surface_rays.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

// Traversals of a mesh's tree, in the mesh's own frame, unscaled. None of them misses a triangle;
// all may show some more than asked for. Scratch of fixed size lies on the stack, 90 KB for pairs,
// 40 KB for rays and 3 KB for the others. Serial, and the same output on any instruction set.

/// Slots of all triangles whose boxes meet [min, max], ascending. Bounds may be infinite.
void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  SlotSink& out) noexcept;

/// A hull beside a mesh.
struct MeshHull {
  const HullShape& shape;
  /// From the frame of the mesh to that of the hull.
  MeshPlacement mesh_in_hull;
  /// In lengths of the hull: triangles count that are no farther from its core.
  double reach;
};

/// The same, but for triangles whose closest point to `center` is farther than `radius`; a few that
/// are farther by less than the rounding of float coordinates, or by more if they are slivers, are
/// left in. A radius that is not finite leaves in all. With a hull that the ball contains, of those
/// within its reach: others are left in only where no face of it and no way to its middle parts
/// them, or where it is so thin, so far away or so far from its own origin that floats tell little.
void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  const double center[3], double radius, const MeshHull* hull,
                  SlotSink& out) noexcept;

/// Slots of triangles that may reach below normal . x <= offset, ascending.
void mesh_below(const MeshView& mesh, const double normal[3], double offset,
                SlotSink& out) noexcept;

/// Pairs (slot of a, slot of b) of triangles that may meet once b is placed in the frame of a and
/// grown by `margin[k]` to both sides on axis k of that frame: those that neither their boxes nor
/// the plane of one of them parts, each once.
void mesh_overlap_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                        const double margin[3], SlotPairSink& out) noexcept;

/// Shows pairs of triangles that may be no farther apart than `limit`, in the lengths of a, once b
/// is placed in the frame of a; where b is may be wrong by `doubt[k]` on axis k. A limit below zero
/// ends it.
void mesh_near_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                     const double doubt[3], double limit, const SlotPairVisitor& visitor) noexcept;

// A visitor is shown the slots of one leaf at a time, or some of them, nearest first, and the limit
// it gives back holds from then on; one below zero ends the traversal.

/// Slots of triangles whose boxes the moving box [min, max] + t * direction may meet at some t in
/// [0, limit], roughly in the order in which it does.
void mesh_sweep(const MeshView& mesh, const double min[3], const double max[3],
                const double direction[3], double limit, const SlotVisitor& visitor) noexcept;

/// Slots of triangles that, multiplied by `scale` along the axes, may be no farther than `limit`
/// from [min, max] (in scaled coordinates), roughly the nearest first, one at a time. Of those
/// without area, which stand for other things, it is the boxes that may be.
void mesh_near(const MeshView& mesh, const double scale[3], const double min[3],
               const double max[3], double limit, const SlotVisitor& visitor) noexcept;

// The jobs that these hand to their kernels. Plain structs: kernel files include this.

/// A ball to be near to: coordinates relative to the middle are multiplied by `scale`, a power of
/// two that makes the radius about 1.
struct MeshBallJob {
  float center[3];
  float scale;
  /// Scaled; the largest coordinate of the middle too.
  float radius;
  float largest;
};

/// A hull to be near to; null: none. Corners x of triangles are brought into its own frame by
/// matrix (x - middle) + offset, scaled by a power of two that makes its radius about 1 and
/// measured from its centre.
struct MeshHullJob {
  const HullShape* shape;
  float middle[3];
  float matrix[3][3];
  float offset[3];
  /// In its own frame, unscaled.
  float center[3];
  float scale;
  /// Scaled: how near triangles count, and the largest number among the vertices.
  float reach;
  float largest;
};

/// A box to find triangles in: in the units of the nodes, and rounded inward to floats, which
/// compare with float corners as the double box does.
struct MeshBoxJob {
  float node_low[3];
  float node_high[3];
  float low[3];
  float high[3];
  bool has_ball;
  MeshBallJob ball;
  MeshHullJob hull;
};

/// Mesh b placed in the frame of mesh a. Rows of the matrix of axes on which b leaves the range in
/// which doubles can be trusted are zero, and their slack is infinite.
struct MeshPairJob {
  double matrix[3][3];
  double offset[3];
  /// By which b is grown: the margin and the rounding of its placement.
  double slack[3];
  /// A power of two that brings the corners of a to about 1, where products of three lengths stay
  /// inside the range of float, and the slack in that scale.
  float scale;
  float scaled_slack[3];
};

/// A box that moves by t * direction. On static axes it does not, or so little that [min, max] is
/// grown by its way.
struct MeshSweepJob {
  double min[3];
  double max[3];
  double inverse[3];
  double direction[3];
  bool is_static[3];
};

/// A box to be near to, and the factors by which the mesh is scaled.
struct MeshNearJob {
  double min[3];
  double max[3];
  double scale[3];
};

/// Is shown what each of several rays meets, and gives back that ray's new limit; one below zero
/// ends its way.
struct RaySlotVisitor {
  /// A triangle that it meets for certain.
  double (*meet)(void* context, std::uint32_t ray, std::uint32_t slot, const SurfaceHit& hit,
                 double limit) = nullptr;
  /// One that it may meet.
  double (*look)(void* context, std::uint32_t ray, std::uint32_t slot, double limit) = nullptr;
  void* context = nullptr;
};

struct MeshKernels {
  void (*overlap)(const MeshView& mesh, const MeshBoxJob& job, SlotSink& out);
  void (*pairs)(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out);
  void (*sweep)(const MeshView& mesh, const MeshSweepJob& job, double limit,
                const SlotVisitor& visitor);
  void (*near_pairs)(const MeshView& a, const MeshView& b, const MeshPairJob& job, double limit,
                     const SlotPairVisitor& visitor);
  /// Takes rays into the frame of a surface; gives back a bit for each that is left to the caller.
  std::uint64_t (*place_rays)(const SurfaceFrame& frame, const RayColumns<kRaysAtOnce>& world,
                              std::uint32_t count, SurfaceRays& own);
  void (*rays)(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
               std::uint32_t count, const RaySlotVisitor& visitor);
  void (*ray)(const MeshView& mesh, const LoneSurfaceRay& ray, double limit,
              const RaySlotVisitor& visitor);
  Crossing (*cross)(const SurfaceRay& ray, const double (&corner)[3][3], SurfaceHit& hit);
  void (*near)(const MeshView& mesh, const MeshNearJob& job, double limit,
               const SlotVisitor& visitor);
};

WINNOW_KERNELS(MeshKernels, mesh_kernels);

}  // namespace winnow
