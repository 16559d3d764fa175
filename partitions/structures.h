#pragma once

// The structures of a partition, and the choice among them.

#include <winnow/core/export.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace winnow {

struct StructureInfo;

/// The structure that prunes the objects of a partition: a value returned by one of the functions
/// below. A program links only the code of the structures that it names.
class WINNOW_API StructureKind {
 public:
  /// No structure; functions that take a StructureKind return `invalid_argument` for it.
  constexpr StructureKind() noexcept = default;
  /// Called by the source file of a structure.
  constexpr explicit StructureKind(const StructureInfo& info, float parameter = 0.0F) noexcept
      : info_(&info), parameter_(parameter) {}

  /// Returns a stable name, e.g. "LinearBvh"; empty if there is no structure.
  [[nodiscard]] std::string_view name() const noexcept;

  /// Returns the table of the structure, which only the library reads; null if there is no
  /// structure.
  [[nodiscard]] constexpr const StructureInfo* info() const noexcept { return info_; }
  /// Returns the parameter given to the function, e.g. `loose` of an octree; 0 without one.
  [[nodiscard]] constexpr float parameter() const noexcept { return parameter_; }

  /// Compares structure and parameter.
  friend constexpr bool operator==(const StructureKind&, const StructureKind&) noexcept = default;

 private:
  const StructureInfo* info_ = nullptr;
  float parameter_ = 0.0F;
};

/// X(function, parameters) for each structure, in the order in which reports list them. The code
/// is in folders of partitions/structures/; a folder can be deleted together with its lines here.
#define WINNOW_STRUCTURES(X)                                                                       \
  /** Every pair, untested: n(n-1)/2 pairs. A baseline for the value of pruning. */                \
  X(n_squared, )                                                                                   \
  /** Brute force: every volume against every other, 16 at a time. Least memory; fastest for a     \
     few dozen objects. */                                                                         \
  X(bounds_n_squared, )                                                                            \
  /** Sweep and prune in strips that stay sorted. For many moving objects of similar size and      \
     long thin worlds. */                                                                          \
  X(sweep_and_prune, )                                                                             \
  /** Grid with cells of one size. For objects of similar size and even density. */                \
  X(flat_grid, )                                                                                   \
  /** A grid for each class of sizes. For many moving objects, of one size or of many. */          \
  X(hierarchical_grid, )                                                                           \
  /** Loose octree. `loose` is the edge length of a loose cell divided by that of its cell,        \
     clamped to [1.125, 8]. With a larger value objects move farther before they leave their node, \
     but nodes overlap more. */                                                                    \
  X(loose_octree, float loose = 2.0F)                                                              \
  /** Loose quadtree over the two axes with the largest extent. For flat worlds. */                \
  X(loose_quadtree, float loose = 2.0F)                                                            \
  /** BVH that is refitted. The default choice if nothing is known about the scene. */             \
  X(linear_bvh, )                                                                                  \
  /** BVH as above with a build that takes many times as long and a better tree: for objects       \
     that hardly move and are queried often. */                                                    \
  X(static_bvh, )                                                                                  \
  /** Chooses one of the others, and may change the choice in any refresh. Links all of them. */   \
  X(automatic, )

#define WINNOW_DECLARE_STRUCTURE(function, ...) \
  [[nodiscard]] WINNOW_API StructureKind function(__VA_ARGS__) noexcept;
WINNOW_STRUCTURES(WINNOW_DECLARE_STRUCTURE)
#undef WINNOW_DECLARE_STRUCTURE

/// Returns all structures with their default parameters. Links them all.
[[nodiscard]] WINNOW_API std::span<const StructureKind> all_structures() noexcept;

/// Returns the structure of this name, or a kind without a structure. Links them all.
[[nodiscard]] WINNOW_API StructureKind structure_named(std::string_view name) noexcept;

/// Features of a scene, estimated from a sample of its boxes: input for the prediction of a
/// structure's cost. Equal on every machine.
struct SceneFeatures {
  std::size_t objects = 0;  ///< objects in the scene
  /// Per axis, the range of the middle 96 % of the objects divided by their mean edge on this axis.
  /// An axis with a small value prunes nothing.
  std::array<double, 3> room{};
  /// log2 of the ratio of longest edges between a large and a small object (95th and 5th
  /// percentile); 0 if all sizes are equal.
  double size_spread = 0.0;
  /// How strongly objects cluster: log2 of (probability that two sampled objects are in the same of
  /// 64 cells) / (the same probability in an even scene). 0 if even, at most 6. The probability is
  /// Simpson's index without pairs of an object with itself.
  double crowding = 0.0;
  /// Estimated pairs per object: the number in an even distribution times the factor by which
  /// objects cluster; at most 16.
  double pairs = 0.0;
};

/// The structure that `automatic()` has chosen, and the reason.
struct StructureChoice {
  StructureKind structure;    ///< the structure in use
  std::string_view reason;    ///< a few words
  std::uint64_t changes = 0;  ///< changes of structure after the first choice
  SceneFeatures features;     ///< features of the scene that the choice is based on
};

}  // namespace winnow
