#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <deque>
#include <memory_resource>
#include <ostream>
#include <vector>

#include "tests/pipeline/own_sets.h"
#include "tests/support/random.h"

namespace winnow::test {

/// Pairs of bodies, 2i and 2i + 1 being pair i or the other way round.
struct PairScene {
  explicit PairScene(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : pool(memory) {}

  /// What shapes of the pool read; their places do not change.
  std::deque<OwnSet> own;
  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  std::vector<BodyPair> pairs;

  [[nodiscard]] Bodies bodies() const { return {shapes, poses}; }
};

/// What is special about the pairs of a scene.
enum class PairStyle {
  /// Sizes within 1:4, half of them overlap.
  ordinary,
  /// Zero extents, slivers, needles, points; coincident positions and equal orientations.
  degenerate,
  /// Small multiples of one half and rotations of small rational numbers: many touch exactly.
  lattice,
  /// Sizes up to 1:1e8.
  unequal,
  /// Orientations that differ by angles down to 1e-12.
  nearly_parallel,
  /// Sizes from 1e-20 to 1e15, both of a pair alike.
  extreme_sizes,
};
inline constexpr PairStyle kPairStyles[] = {PairStyle::ordinary,        PairStyle::degenerate,
                                            PairStyle::lattice,         PairStyle::unequal,
                                            PairStyle::nearly_parallel, PairStyle::extreme_sizes};
[[nodiscard]] const char* to_string(PairStyle style);
inline void PrintTo(PairStyle style, std::ostream* out) {
  *out << to_string(style);
}

/// The kinds that the oracle knows against each other. Hulls only if the library makes them.
[[nodiscard]] std::vector<ShapeKind> polytope_kinds();
/// All kinds of shape but those known by a support function, hulls only if the library makes them.
[[nodiscard]] std::vector<ShapeKind> all_kinds();

/// Adds `count` pairs of the two kinds.
void add_pairs(PairScene& scene, ShapeKind a, ShapeKind b, PairStyle style, std::size_t count,
               Random& random);

/// A length that bounds the sizes of both shapes; of a half-space it is its offset.
[[nodiscard]] double extent(const PairScene& scene, BodyPair pair);

}  // namespace winnow::test
