#pragma once

// Levels of detail of contacts, and contact points. The structs are plain, because kernel files
// include this header.

#include <winnow/core/export.h>
#include <winnow/core/vectors.h>

#include <cstdint>

namespace winnow {

/// How much is computed about pairs. A lower level does none of the work that only a higher level
/// needs.
enum class ContactLevel : std::uint8_t {
  /// Pairs of bodies whose boxes overlap. The boxes are enlarged by half of the contact margin, by
  /// SceneOptions::cache_tolerance and by contact offsets. Only for scenes.
  pairs,
  /// Pairs that share a point, and the parts that do.
  boolean,
  /// Pairs whose gap is at most the margin: distance or depth, normal, closest points.
  distance,
  /// As `distance`, with contact points instead of closest points.
  manifold,
};

/// Two bodies that may touch.
struct BodyPair {
  std::uint32_t a = 0;  ///< index of the first body
  std::uint32_t b = 0;  ///< index of the second
};

/// Part number of a convex shape, which has no parts.
inline constexpr std::uint32_t kWholeShape = ~0U;

/// One point of a manifold: halfway between the two surfaces, in world axes, relative to the
/// position of body a. The feature identifies the vertex, edge or face of a (upper half) and of b
/// (lower half) that generated the point; it has the same value in each frame in which these two
/// generate the point.
struct ContactPoint {
  Vec3f position;         ///< relative to the position of body a
  float depth;            ///< positive if the bodies overlap there, negative if they are apart
  std::uint64_t feature;  ///< equal features in two frames are the same point
};

/// Index of no pair or point: the contact did not exist in the previous frame.
inline constexpr std::uint32_t kNoContact = ~0U;

/// Largest number of points per manifold.
inline constexpr std::uint32_t kManifoldPoints = 4;

/// Result for one pair of shapes.
struct PairAnswer {
  /// Signed distance: minus the penetration depth (the length of the shortest translation that
  /// separates the shapes) if they overlap.
  double distance = 0.0;
  /// The true distance is within distance +- error_bound.
  double error_bound = 0.0;
  Vec3d normal = {1.0, 0.0, 0.0};  ///< unit vector from a to b, in world axes
  /// Closest (or deepest) point of a, relative to the position of a, in world axes. The point of b
  /// is point + distance * normal.
  Vec3d point{};
  bool overlap = false;                         ///< true if the shapes share a point
  std::uint32_t contact_count = 0;              ///< number of contact points
  ContactPoint contacts[kManifoldPoints] = {};  ///< empty if the gap exceeds the margin
};

}  // namespace winnow
