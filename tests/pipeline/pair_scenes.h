#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <deque>
#include <memory_resource>
#include <ostream>
#include <vector>

#include "tests/pipeline/user_shapes.h"
#include "tests/support/random.h"

namespace winnow::test {

/// Pairs of bodies: pair i has the bodies 2i and 2i + 1 in either order.
struct PairScene {
  explicit PairScene(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : pool(memory) {}

  /// User shapes that the pool refers to; their addresses do not change.
  std::deque<UserShape> own;
  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  std::vector<BodyPair> pairs;

  [[nodiscard]] Bodies bodies() const { return {shapes, poses}; }
};

/// The style of the random pairs of a scene.
enum class PairStyle {
  /// Sizes within 1:4; half of the pairs overlap.
  ordinary,
  /// Zero extents, slivers, needles, points; coincident positions and equal orientations.
  degenerate,
  /// Small multiples of one half and rational rotations: many pairs touch exactly.
  lattice,
  /// Sizes up to 1:1e8.
  unequal,
  /// Orientations that differ by angles down to 1e-12.
  nearly_parallel,
  /// Sizes from 1e-20 to 1e15, both shapes of a pair of similar size.
  extreme_sizes,
};
inline constexpr PairStyle kPairStyles[] = {PairStyle::ordinary,        PairStyle::degenerate,
                                            PairStyle::lattice,         PairStyle::unequal,
                                            PairStyle::nearly_parallel, PairStyle::extreme_sizes};
[[nodiscard]] const char* to_string(PairStyle style);
inline void PrintTo(PairStyle style, std::ostream* out) {
  *out << to_string(style);
}

/// Returns the kinds whose pairs the oracle supports; hulls only if the library supports hulls.
[[nodiscard]] std::vector<ShapeKind> polytope_kinds();
/// Returns all kinds except shapes given by support functions; hulls only if the library supports
/// hulls.
[[nodiscard]] std::vector<ShapeKind> all_kinds();

/// Adds `count` pairs of the two kinds.
void add_pairs(PairScene& scene, ShapeKind a, ShapeKind b, PairStyle style, std::size_t count,
               Random& random);

/// Returns a length that bounds the sizes of both shapes. For a half-space it uses the offset.
[[nodiscard]] double extent(const PairScene& scene, BodyPair pair);

}  // namespace winnow::test
