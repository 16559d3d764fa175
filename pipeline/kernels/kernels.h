#pragma once

// What the narrow phase hands to its kernels, and which kernels there are. Plain structs: kernel
// files include this.

#include <winnow/core/pose.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// At most so many pairs per job.
inline constexpr std::uint32_t kJobPairs = 512;

/// Kernels write contact points by whole vectors: the last of them may reach this far beyond.
inline constexpr std::uint32_t kContactSlack = 16;

/// Contact points in the order in which they are written, one column per member.
struct ContactWriter {
  float* position[3];
  float* depth;
  std::uint64_t* feature;
  /// Points so far. There is room for kManifoldPoints per pair of the job, and for kContactSlack
  /// more.
  std::uint32_t size;
};

/// A run of pairs of one kind and where their answers go: element i of every column for pairs[i].
/// All pairs are in the kinds' order: the shape of `a` is of the smaller kind.
struct NarrowJob {
  const BodyPair* pairs;
  std::uint32_t count;
  /// By body.
  const ShapeId* shapes;
  const Pose* poses;
  /// Whether poses fill more than the nearer caches: kernels ask memory for them ahead.
  bool has_many_bodies;
  const ShapeTables* tables;
  /// Contacts are made of pairs that are no farther apart.
  double margin;
  /// A margin for each pair, readable up to a multiple of 16; null: `margin` for all.
  const double* margins;

  /// Level boolean: 1 where the shapes share a point.
  std::uint8_t* overlap;
  /// Levels distance and manifold. Distance is negative by the penetration depth, and <= 0 exactly
  /// where the shapes share a point. At level manifold a pair farther apart than the margin may
  /// have any lower bound of its distance that is above the margin.
  double* distance;
  /// The true distance is within distance +- error_bound.
  double* error_bound;
  /// Unit vectors from a to b, in the axes of the world.
  double* normal[3];
  /// Level distance: the point of a, relative to the position of body a, in the axes of the world.
  /// That of b is distance * normal farther.
  double* point[3];
  /// Level manifold: points of pair i are contacts[contact_first[i] .. + contact_count[i]).
  std::uint32_t* contact_first;
  std::uint32_t* contact_count;
  ContactWriter contacts;

  /// Room for `count` indices of pairs that the kernel could not certify. Nothing of theirs needs
  /// to have been written.
  std::uint32_t* uncertified;

  [[nodiscard]] double margin_of(std::uint32_t pair) const {
    return margins == nullptr ? margin : margins[pair];
  }
};

/// Answers a job; returns the number of uncertified pairs.
using NarrowKernel = std::uint32_t (*)(NarrowJob& job);

/// The kernels of one pair kind. What is not in `uncertified` has the right sign and a bound of at
/// most 1e-12 x (sizes + |distance|), or 1e-9 where cylinders, cones, ellipsoids and tapered
/// capsules meet more than spheres and half-spaces, or 4e-7 of a program's own sets.
struct NarrowKernels {
  /// By kernel_index of the level.
  NarrowKernel of_level[3];
};

/// The kinds of pairs that have kernels, as WINNOW_X(a, b): their table is `a_b_kernels()`, which a
/// kernel file defines as WINNOW_KERNEL_TABLE(a_b_kernels).
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

/// Where the kernel of a level stands in NarrowKernels. Level pairs has none.
[[nodiscard]] constexpr std::uint32_t kernel_index(ContactLevel level) noexcept {
  return static_cast<std::uint32_t>(level) - static_cast<std::uint32_t>(ContactLevel::boolean);
}

/// The active kernels of a pair kind, a <= b; null where the solver answers.
[[nodiscard]] const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept;

}  // namespace winnow
