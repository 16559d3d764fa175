#pragma once

#include "pipeline/mesh/mesh_view.h"

namespace winnow {

// Traversals of a mesh's tree, in the mesh's own frame, unscaled. None of them misses a triangle;
// all may show some more than asked for. Scratch of fixed size lies on the stack, 60 KB for pairs
// and 3 KB for the others. Serial, and the same output on any instruction set.

/// Slots of all triangles whose boxes meet [min, max], ascending. Bounds may be infinite.
void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  SlotSink& out) noexcept;

/// The same, but for triangles whose closest point to `center` is farther than `radius`; a few that
/// are farther by less than the rounding of float coordinates, or by more if they are slivers, are
/// left in. A radius that is not finite leaves in all.
void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  const double center[3], double radius, SlotSink& out) noexcept;

/// Slots of triangles that may reach below normal . x <= offset, ascending.
void mesh_below(const MeshView& mesh, const double normal[3], double offset,
                SlotSink& out) noexcept;

/// Pairs (slot of a, slot of b) of triangles that may meet once b is placed in the frame of a and
/// grown by `margin[k]` to both sides on axis k of that frame: those that neither their boxes nor
/// the plane of one of them parts, each once.
void mesh_overlap_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                        const double margin[3], SlotPairSink& out) noexcept;

// A visitor is shown the slots of one leaf at a time, nearest first, and the limit it gives back
// holds from the next leaf on; one below zero ends the traversal.

/// Slots of triangles whose boxes the moving box [min, max] + t * direction may meet at some t in
/// [0, limit], roughly in the order in which it does.
void mesh_sweep(const MeshView& mesh, const double min[3], const double max[3],
                const double direction[3], double limit, const SlotVisitor& visitor) noexcept;

/// Slots of triangles whose boxes, all multiplied by `scale` along the axes, may be no farther than
/// `limit` from [min, max] (in scaled coordinates), roughly the nearest first.
void mesh_near(const MeshView& mesh, const double scale[3], const double min[3],
               const double max[3], double limit, const SlotVisitor& visitor) noexcept;

}  // namespace winnow
