#pragma once

#include "pipeline/composites/convex_patch.h"
#include "pipeline/composites/surface_cones.h"

#include <cstddef>
#include <cstdint>

namespace winnow::mid {

/// Error of a touched point of a patch, relative to the size of the patch.
inline constexpr double kPatchSlack = 1e-5;

/// The contact of the convex patches around two primitives that overlap: the least translation that
/// parts them. A primitive that is no triangle of a surface has no patch.
struct PatchContact {
  ConvexPatch side[2];
  /// The primitives.
  std::uint32_t other[2] = {};
  Vec normal;
  double distance = 0.0;
  double error = 0.0;
  /// The deepest points of a and b.
  Vec touched[2];
  /// The normal is in the normal cones of both patches.
  bool is_valid = false;

  /// Returns whether this is the contact of two primitives.
  [[nodiscard]] bool is_of(const BodyPair& primitives) const noexcept;
};

/// Computes contacts of patches.
class PatchSolver {
 public:
  PatchSolver(const ShapeTables& tables, const PrimitivePairs& pairs,
              const SurfaceCones& cones) noexcept
      : tables_(tables), pairs_(pairs), cones_(cones) {}

  /// Finds the contact of `contact.other` from their patches in `contact.side`, which may grow.
  void solve(const AnswerGroup& group, PatchContact& contact) const noexcept;

 private:
  [[nodiscard]] bool solve_gentle(PatchContact& contact) const noexcept;
  void solve_convex(PatchContact& contact) const noexcept;
  [[nodiscard]] bool grow_to_blockers(const AnswerGroup& group,
                                      PatchContact& contact) const noexcept;

  const ShapeTables& tables_;
  const PrimitivePairs& pairs_;
  const SurfaceCones& cones_;
};

}  // namespace winnow::mid
