#pragma once

#include "pipeline/composites/bump_allocator.h"
#include "pipeline/composites/transformed_shape.h"

#include <array>
#include <cstdint>
#include <span>

namespace winnow::mid {

/// Finds the pairs of primitives that may touch, for a chunk of body pairs. Writes each primitive
/// to an arena, as its number in its body. After the searches of all tasks,
/// find_primitive_pairs.cpp copies the shapes, poses and pairs of these primitives to
/// PrimitivePairs.
class PrimitivePairSearch {
 public:
  explicit PrimitivePairSearch(BumpAllocator& arena) noexcept;

  /// Finds all pairs of primitives that are no farther apart than `margin`, and some that are.
  /// Primitives are appended to `primitives()` by number, with kSecond set for body b; pairs are
  /// appended to `pairs()` as two indices into the primitives of this search.
  void run(const TransformedShape& a, const TransformedShape& b, double margin) noexcept;

  static constexpr std::uint32_t kSecond = 1U << 31U;

  [[nodiscard]] const WordWriter& primitives() const noexcept { return primitives_; }
  [[nodiscard]] const WordWriter& pairs() const noexcept { return pairs_; }
  [[nodiscard]] std::uint64_t triangles() const noexcept { return triangles_; }

 private:
  static constexpr std::uint32_t kRoom = 512;
  static constexpr std::uint32_t kRemembered = 128;
  using Room = std::array<std::uint32_t, kRoom>;
  struct FoundPrimitive {
    std::uint32_t number = ~0U;
    std::uint64_t primitive = 0;
  };

  struct PairOfBodies {
    PrimitivePairSearch& search;
    const TransformedShape& a;
    const TransformedShape& b;
  };

  /// Requires bodies that are not compounds with surfaces.
  void run(const TransformedShape& a, const TransformedShape& b) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> bodies_near(const TransformedShape& body,
                                                           const Box3& box, Room& room) noexcept;
  void parts_parts(const TransformedShape& a, const TransformedShape& b) noexcept;
  void parts_surface(const TransformedShape& parts, const TransformedShape& surface,
                     bool mirrored) noexcept;
  [[nodiscard]] bool is_left_out(const PlacedPart& part, const Box3& about,
                                 const TransformedShape& surface,
                                 std::uint32_t triangle) const noexcept;
  void mesh_mesh(const TransformedShape& a, const TransformedShape& b) noexcept;
  static void take_slots(void* context, SlotPairSink& found) noexcept;
  void surfaces(const TransformedShape& a, const TransformedShape& b) noexcept;

  [[nodiscard]] std::span<const std::uint32_t> children_near(const TransformedShape& body,
                                                             const Box3& box, Room& room) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> triangles_near(
      const PlacedPart& part, const TransformedShape& surface) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> triangles_near(const Box3& box,
                                                              const TransformedShape& surface,
                                                              Room& room) noexcept;
  template <typename Find>
  [[nodiscard]] std::span<const std::uint32_t> collect(Room& room, Find&& find) noexcept;

  /// True if one of the triangles is one-sided and the other is behind it.
  [[nodiscard]] static bool any_is_behind(const TransformedShape& a, const Corners& of_a,
                                          const TransformedShape& b, const Corners& of_b) noexcept;

  /// Adds the first primitives of both, which must not be compounds with surfaces.
  void add_any(const TransformedShape& a, const TransformedShape& b) noexcept;
  void add(const TransformedShape& a, std::uint32_t of_a, const TransformedShape& b,
           std::uint32_t of_b) noexcept;
  [[nodiscard]] std::uint32_t primitive(const TransformedShape& body, std::uint32_t number,
                                        std::uint32_t flag) noexcept;

  /// Margin of the current pair of bodies.
  double margin_ = 0.0;
  BumpAllocator& arena_;
  WordWriter primitives_;
  WordWriter pairs_;
  std::uint64_t triangles_ = 0;
  /// Number of primitives before the current pair of bodies.
  std::uint64_t before_ = 0;
  /// Recently added primitives of each body, so that few are written twice.
  std::array<FoundPrimitive, kRemembered> memory_[2];
  Room outer_;
  Room inner_;
  /// Children of compounds that have surfaces.
  Room children_[2];
};

}  // namespace winnow::mid
