#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/scenes/lens.h"
#include "bench/scenes/pair_kind.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace winnow::bench {

/// Seeded random pairs of one kind, each of two bodies of its own, random in size and orientation;
/// every second pair overlaps.
struct PairSet {
  PairKind kind;
  /// What shapes of the pool read.
  std::deque<Lens> lenses;
  ShapePool pool;
  std::vector<ShapeId> shapes;  ///< by body
  std::vector<Pose> poses;      ///< by body
  std::vector<double> radius;   ///< by body: of the ball about its position that contains it
  std::vector<BodyPair> pairs;

  [[nodiscard]] Bodies bodies() const noexcept { return {shapes, poses}; }
};

struct PairSetOptions {
  std::size_t pairs = 8192;
  std::uint64_t seed = 1;
  /// The shapes of b are so many times as large as those of a.
  double ratio = 1.0;
  /// Bodies lie in random order in memory, instead of next to their partner.
  bool scattered = false;
  /// Instead of drawing lots, moves b along a random line through the position of a until they
  /// touch, and from there by a length of random sign and magnitude, up to the radius of the
  /// smaller body: at least 0.05 radii in one half of the set, at least this many in the other. 0:
  /// draws lots.
  double nearest = 0.0;
  /// Moves every body so far along each axis. Positions are multiples of 2^-12 then, so that the
  /// pairs of a seed are the same at any offset up to 1e12.
  std::optional<double> offset{};
  /// b stands as a does, but for a turn about a random axis by an angle whose half has half of this
  /// as its tangent.
  std::optional<double> angle{};
  /// At most 1: triangles are drawn, and then one corner is brought to the opposite edge until it
  /// is only so many times as far from it.
  double thinness = 1.0;
  /// Bodies stand upright, turned about the vertical axis alone, hulls are prisms and triangles
  /// walls: edges and faces are parallel, as in most of what people build.
  bool upright = false;
};

/// Position, orientation and size are drawn uniformly, b's centre in a ball a little larger than
/// that in which the bodies' bounding balls meet, until winnow says of the pair what it should
/// (which takes long of sizes that are far apart, unless they are brought near). Hulls are shared
/// by bodies, as in a simulation; other shapes are the body's own. Throws std::runtime_error if
/// winnow does not answer.
[[nodiscard]] std::unique_ptr<PairSet> make_pair_set(const PairKind& kind,
                                                     const PairSetOptions& options);

}  // namespace winnow::bench
