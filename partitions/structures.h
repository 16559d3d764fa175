#pragma once

#include <winnow/core/export.h>

#include <span>
#include <string_view>

namespace winnow {

struct StructureInfo;

/// Which structure prunes the objects of a partition: a value, made by one of the functions below.
/// A program gets the code of the structures that it names, and of no other.
class WINNOW_API StructureKind {
 public:
  /// Names no structure; what takes one answers `invalid_argument`.
  constexpr StructureKind() noexcept = default;
  /// For a structure's own source file.
  constexpr explicit StructureKind(const StructureInfo& info, float parameter = 0.0F) noexcept
      : info_(&info), parameter_(parameter) {}

  /// Stable, e.g. "LinearBvh"; empty if it names none.
  [[nodiscard]] std::string_view name() const noexcept;

  /// What the library knows the structure by; null if it names none.
  [[nodiscard]] constexpr const StructureInfo* info() const noexcept { return info_; }
  /// That the function was given, as `loose` of an octree; 0 for structures without one.
  [[nodiscard]] constexpr float parameter() const noexcept { return parameter_; }

  /// Same structure, same parameter.
  friend constexpr bool operator==(const StructureKind&, const StructureKind&) noexcept = default;

 private:
  const StructureInfo* info_ = nullptr;
  float parameter_ = 0.0F;
};

/// All structures, in the order in which reports list them: a function, and its parameters. Each
/// lives in a folder of partitions/structures/ that can be deleted with its line here.
#define WINNOW_STRUCTURES(X)                                                                   \
  /** Every pair, untested: n(n-1)/2 of them. The baseline that says what a test is worth. */  \
  X(n_squared, )                                                                               \
  /** The bounding volume of every object against every other, 16 at a time: the least memory, \
     the fastest for some dozens of objects. */                                                \
  X(bounds_n_squared, )                                                                        \
  /** Strips that are kept sorted. Much moves, sizes are alike, long thin worlds. */           \
  X(sweep_and_prune, )                                                                         \
  /** Cells of one size. Sizes are alike and density is even. */                               \
  X(flat_grid, )                                                                               \
  /** A grid for each class of sizes. Much moves, in scenes of one size or many. */            \
  X(hierarchical_grid, )                                                                       \
  /** Loose cells of every size; `loose` is the edge of a loose cell in edges of its cell, in  \
     [1.125, 8], and what lies outside is taken as the nearest end. Larger: objects move       \
     farther before they leave their node, and nodes overlap more. Measured where sizes are    \
     mixed: 1.5 and 3 cost 7 to 14 % more tests than 2. */                                     \
  X(loose_octree, float loose = 2.0F)                                                          \
  /** The same over the two axes with the most room. Flat worlds. */                           \
  X(loose_quadtree, float loose = 2.0F)                                                        \
  /** A tree of boxes that is refitted: take it when you do not know. */                       \
  X(linear_bvh, )                                                                              \
  /** The same in an order that takes many times as long to find: for what hardly moves and    \
     is asked much. */                                                                         \
  X(static_bvh, )                                                                              \
  /** Holds one of the others, goes on picking, and links all that it picks from. */           \
  X(automatic, )

#define WINNOW_DECLARE_STRUCTURE(function, ...) \
  [[nodiscard]] WINNOW_API StructureKind function(__VA_ARGS__) noexcept;
WINNOW_STRUCTURES(WINNOW_DECLARE_STRUCTURE)
#undef WINNOW_DECLARE_STRUCTURE

/// All of them with their default parameters. Links them all.
[[nodiscard]] WINNOW_API std::span<const StructureKind> all_structures() noexcept;

/// The one of this name; one that names none if there is no such name. Links them all.
[[nodiscard]] WINNOW_API StructureKind structure_named(std::string_view name) noexcept;

}  // namespace winnow
