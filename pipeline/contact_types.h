#pragma once

// What is asked about pairs of bodies and what a contact is. Plain structs on purpose: kernel files
// include this.

#include <winnow/core/export.h>

#include <cstdint>

namespace winnow {

/// How much is asked about pairs. A lower level does not pay for a higher one.
enum class ContactLevel : std::uint8_t {
  /// Of a scene alone: pairs of bodies whose boxes, grown by half of the margin, meet.
  pairs,
  /// Those that share a point, and which of their parts do.
  boolean,
  /// Those no farther apart than the margin: distance or depth, normal, closest points.
  distance,
  /// The same with contact points.
  manifold,
};

/// Two bodies that may touch.
struct BodyPair {
  std::uint32_t a = 0;  ///< index of the first body
  std::uint32_t b = 0;  ///< index of the second
};

/// The part of a shape that has no parts: all of a convex one.
inline constexpr std::uint32_t kWholeShape = ~0U;

/// One point of a manifold: halfway between the two surfaces, in the axes of the world, relative to
/// the position of body a. Depth is positive where the bodies overlap. The feature says which
/// vertex, edge or face of a (upper half) and of b (lower half) made the point, and is the same
/// from frame to frame as long as they do.
struct ContactPoint {
  float position[3];      ///< x, y, z
  float depth;            ///< negative where the bodies are apart, within the margin
  std::uint64_t feature;  ///< equal features of two frames are the same point
};

/// No pair or point: of contacts that were not there in the last frame.
inline constexpr std::uint32_t kNoContact = ~0U;

/// At most so many points per manifold.
inline constexpr std::uint32_t kManifoldPoints = 4;

/// What is known about one pair of shapes.
struct PairAnswer {
  /// Negative by the penetration depth: the length of the shortest translation that parts them.
  double distance = 0.0;
  /// The true distance is within distance +- error_bound.
  double error_bound = 0.0;
  double normal[3] = {1.0, 0.0, 0.0};  ///< unit, from a to b, in the axes of the world
  /// On a, relative to the position of a, in the axes of the world. The point of b is
  /// distance * normal farther.
  double point[3] = {0.0, 0.0, 0.0};
  bool overlap = false;                         ///< they share a point
  std::uint32_t contact_count = 0;              ///< of `contacts`
  ContactPoint contacts[kManifoldPoints] = {};  ///< none where they are apart beyond the margin
};

}  // namespace winnow
