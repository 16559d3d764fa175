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

/// Seeded random pairs of one kind. Each pair has its own two bodies of random size and
/// orientation; every second pair overlaps.
struct PairSet {
  PairKind kind;
  /// Storage of the lenses that user shapes in the pool refer to.
  std::deque<Lens> lenses;
  ShapePool pool;
  std::vector<ShapeId> shapes;  ///< by body
  std::vector<Pose> poses;      ///< by body
  std::vector<double> radius;   ///< by body: radius of the ball about its position that contains it
  std::vector<BodyPair> pairs;

  [[nodiscard]] Bodies bodies() const noexcept { return {shapes, poses}; }
};

struct PairSetOptions {
  std::size_t pairs = 8192;
  std::uint64_t seed = 1;
  /// Size of b's shapes relative to a's.
  double ratio = 1.0;
  /// Stores bodies in random order in memory, instead of next to their partner.
  bool scattered = false;
  /// If positive, b is not placed at random but moved along a random line through the position of a
  /// until they touch, and from there by a length of random sign and magnitude, up to the radius of
  /// the smaller body. The length is at least 0.05 radii in one half of the set and at least
  /// `nearest` radii in the other.
  double nearest = 0.0;
  /// Adds this to every coordinate of all positions. Positions are then multiples of 2^-12, so that
  /// the pairs of a seed are the same at any offset up to 1e12.
  std::optional<double> offset{};
  /// b has a's orientation, rotated about a random axis by the angle whose half has the tangent
  /// `angle` / 2.
  std::optional<double> angle{};
  /// At most 1. Moves one vertex of each triangle towards the opposite edge until its distance is
  /// this multiple of the drawn one.
  double thinness = 1.0;
  /// Bodies are upright and rotated only about the vertical axis, hulls are prisms and triangles
  /// have a vertical edge: edges and faces are parallel, as in most man-made scenes.
  bool upright = false;
};

/// Draws positions, orientations and sizes uniformly, with b's centre in a ball a little larger
/// than the range in which the bodies' bounding balls overlap, until winnow's overlap test returns
/// the required result. Many draws are necessary if the sizes differ much and `nearest` is 0.
/// Bodies share hulls, as in a simulation; each body of another kind has a shape of its own. Throws
/// std::runtime_error if winnow rejects a pair.
[[nodiscard]] std::unique_ptr<PairSet> make_pair_set(const PairKind& kind,
                                                     const PairSetOptions& options);

}  // namespace winnow::bench
