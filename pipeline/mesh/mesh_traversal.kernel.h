#pragma once

#include "pipeline/mesh/mesh_view.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// A ball to be near to: coordinates relative to the middle are multiplied by `scale`, a power of
/// two that makes the radius about 1.
struct MeshBallJob {
  float center[3];
  float scale;
  /// Scaled; the largest coordinate of the middle too.
  float radius;
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
  bool is_static[3];
};

/// A box to be near to, and the factors by which the mesh is scaled.
struct MeshNearJob {
  double min[3];
  double max[3];
  double scale[3];
};

struct MeshKernels {
  void (*overlap)(const MeshView& mesh, const MeshBoxJob& job, SlotSink& out);
  void (*pairs)(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out);
  void (*sweep)(const MeshView& mesh, const MeshSweepJob& job, double limit,
                const SlotVisitor& visitor);
  void (*near)(const MeshView& mesh, const MeshNearJob& job, double limit,
               const SlotVisitor& visitor);
};

WINNOW_KERNELS(MeshKernels, mesh_kernels);

}  // namespace winnow
