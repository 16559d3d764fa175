#pragma once

// The interface between the narrow phase and its SIMD kernels: the job that a kernel answers, and
// the list of pair kinds that have kernels. Kernel files, which are compiled once per instruction
// set, include this file, so its types are plain structs.

#include <winnow/core/pose.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// The largest number of pairs in a job.
inline constexpr std::uint32_t kJobPairs = 512;

/// Kernels write contact points as whole vectors: they may write up to this many elements beyond
/// the last contact.
inline constexpr std::uint32_t kContactSlack = 16;

/// Contact points in the order in which they are written, one column per member.
struct ContactWriter {
  float* position[3];
  float* depth;
  std::uint64_t* feature;
  /// Number of points so far. There must be room for kManifoldPoints per pair of the job, plus
  /// kContactSlack.
  std::uint32_t size;
};

/// Consecutive pairs of the same two kinds, and the columns for their answers: element i of every
/// column belongs to pairs[i]. In every pair the shape of `a` is of the smaller kind.
struct NarrowJob {
  const BodyPair* pairs;
  std::uint32_t count;
  /// Indexed by body.
  const ShapeId* shapes;
  const Pose* poses;
  /// True if the poses do not fit in the nearer caches: kernels then prefetch them.
  bool has_many_bodies;
  const ShapeTables* tables;
  /// A pair gets contacts if it is at most this far apart.
  double margin;
  /// A margin for each pair, readable up to a multiple of 16; null if `margin` is for all pairs.
  const double* margins;

  /// Level boolean: 1 if the shapes share a point, else 0.
  std::uint8_t* overlap;
  /// Levels distance and manifold. Minus the penetration depth if the shapes overlap; <= 0 if and
  /// only if they share a point. At level manifold, if a pair is farther apart than the margin,
  /// this may be any lower bound of its distance that is above the margin.
  double* distance;
  /// The true distance is within distance +- error_bound.
  double* error_bound;
  /// Unit vectors from a to b, in world axes.
  double* normal[3];
  /// Level distance: the closest point on a, relative to the position of body a, in world axes. The
  /// closest point on b is point + distance * normal.
  double* point[3];
  /// Level manifold: the contacts of pair i are [contact_first[i], contact_first[i] +
  /// contact_count[i]). Contacts of uncertified pairs follow those of all other pairs.
  std::uint32_t* contact_first;
  std::uint32_t* contact_count;
  ContactWriter contacts;

  /// Room for `count` indices of pairs that the kernel could not certify, among them all pairs with
  /// an invalid pose. The other columns of these pairs are unspecified, also `contact_count`.
  std::uint32_t* uncertified;

  [[nodiscard]] double margin_of(std::uint32_t pair) const {
    return margins == nullptr ? margin : margins[pair];
  }
};

/// Answers a job and returns the number of uncertified pairs.
using NarrowKernel = std::uint32_t (*)(NarrowJob& job);

/// The kernels of one pair kind. An answer that is not in `uncertified` has the right sign and an
/// error bound of at most 1e-12 x (sizes + |distance|); 1e-9 for pairs with a cylinder, cone,
/// ellipsoid or tapered capsule, unless the other shape is a sphere or half-space; 4e-7 for user
/// shapes.
struct NarrowKernels {
  /// Indexed by kernel_index of the level.
  NarrowKernel of_level[3];
};

/// The pair kinds that have kernels, as WINNOW_X(a, b). The table of a pair kind is
/// `a_b_kernels()`, which a kernel file defines as WINNOW_KERNEL_TABLE(a_b_kernels).
#define WINNOW_NARROW_KERNELS(WINNOW_X)      \
  WINNOW_X(sphere, sphere)                   \
  WINNOW_X(sphere, capsule)                  \
  WINNOW_X(sphere, box)                      \
  WINNOW_X(sphere, cylinder)                 \
  WINNOW_X(sphere, cone)                     \
  WINNOW_X(sphere, hull)                     \
  WINNOW_X(sphere, triangle)                 \
  WINNOW_X(sphere, half_space)               \
  WINNOW_X(sphere, ellipsoid)                \
  WINNOW_X(sphere, tapered_capsule)          \
  WINNOW_X(sphere, support)                  \
  WINNOW_X(capsule, capsule)                 \
  WINNOW_X(capsule, box)                     \
  WINNOW_X(capsule, cylinder)                \
  WINNOW_X(capsule, cone)                    \
  WINNOW_X(capsule, hull)                    \
  WINNOW_X(capsule, triangle)                \
  WINNOW_X(capsule, half_space)              \
  WINNOW_X(capsule, ellipsoid)               \
  WINNOW_X(capsule, tapered_capsule)         \
  WINNOW_X(capsule, support)                 \
  WINNOW_X(box, box)                         \
  WINNOW_X(box, cylinder)                    \
  WINNOW_X(box, cone)                        \
  WINNOW_X(box, hull)                        \
  WINNOW_X(box, triangle)                    \
  WINNOW_X(box, half_space)                  \
  WINNOW_X(box, ellipsoid)                   \
  WINNOW_X(box, tapered_capsule)             \
  WINNOW_X(box, support)                     \
  WINNOW_X(cylinder, cylinder)               \
  WINNOW_X(cylinder, cone)                   \
  WINNOW_X(cylinder, hull)                   \
  WINNOW_X(cylinder, triangle)               \
  WINNOW_X(cylinder, half_space)             \
  WINNOW_X(cylinder, ellipsoid)              \
  WINNOW_X(cylinder, tapered_capsule)        \
  WINNOW_X(cylinder, support)                \
  WINNOW_X(cone, cone)                       \
  WINNOW_X(cone, hull)                       \
  WINNOW_X(cone, triangle)                   \
  WINNOW_X(cone, half_space)                 \
  WINNOW_X(cone, ellipsoid)                  \
  WINNOW_X(cone, tapered_capsule)            \
  WINNOW_X(cone, support)                    \
  WINNOW_X(hull, hull)                       \
  WINNOW_X(hull, triangle)                   \
  WINNOW_X(hull, half_space)                 \
  WINNOW_X(hull, ellipsoid)                  \
  WINNOW_X(hull, tapered_capsule)            \
  WINNOW_X(hull, support)                    \
  WINNOW_X(triangle, triangle)               \
  WINNOW_X(triangle, half_space)             \
  WINNOW_X(triangle, ellipsoid)              \
  WINNOW_X(triangle, tapered_capsule)        \
  WINNOW_X(triangle, support)                \
  WINNOW_X(half_space, ellipsoid)            \
  WINNOW_X(half_space, tapered_capsule)      \
  WINNOW_X(half_space, support)              \
  WINNOW_X(ellipsoid, ellipsoid)             \
  WINNOW_X(ellipsoid, tapered_capsule)       \
  WINNOW_X(ellipsoid, support)               \
  WINNOW_X(tapered_capsule, tapered_capsule) \
  WINNOW_X(tapered_capsule, support)         \
  WINNOW_X(support, support)

#define WINNOW_DECLARE_PAIR(a, b) WINNOW_KERNELS(NarrowKernels, a##_##b##_kernels);
WINNOW_NARROW_KERNELS(WINNOW_DECLARE_PAIR)
#undef WINNOW_DECLARE_PAIR

/// Index of the kernel of a level in NarrowKernels. Level `pairs` has no kernel.
[[nodiscard]] constexpr std::uint32_t kernel_index(ContactLevel level) noexcept {
  return static_cast<std::uint32_t>(level) - static_cast<std::uint32_t>(ContactLevel::boolean);
}

/// Returns the linked kernels of a pair kind, a <= b, for the active instruction set; null if there
/// are none and the solver must answer.
[[nodiscard]] const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept;

}  // namespace winnow
