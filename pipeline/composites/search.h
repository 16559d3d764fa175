#pragma once

#include "pipeline/composites/placed_body.h"
#include "pipeline/composites/word_arena.h"

#include <array>
#include <cstdint>
#include <span>

namespace winnow::mid {

/// Finds the primitives of a chunk of body pairs that may touch. Writes them to an arena as numbers
/// within the bodies; expand.cpp copies them out when all tasks have counted theirs.
class Search {
 public:
  Search(const ShapeTables& tables, WordArena& arena) noexcept;

  /// Finds all pairs of primitives that are no farther apart than `margin`, and some more.
  /// Primitives are appended to `primitives()` by number, with kSecond set for body b; pairs are
  /// appended to `pairs()` as two indices into the primitives of this search.
  void run(const PlacedBody& a, const PlacedBody& b, double margin) noexcept;

  static constexpr std::uint32_t kSecond = 1U << 31U;

  [[nodiscard]] const WordWriter& primitives() const noexcept { return primitives_; }
  [[nodiscard]] const WordWriter& pairs() const noexcept { return pairs_; }
  [[nodiscard]] std::uint64_t triangles() const noexcept { return triangles_; }

 private:
  static constexpr std::uint32_t kRoom = 512;
  static constexpr std::uint32_t kRemembered = 128;
  using Room = std::array<std::uint32_t, kRoom>;
  struct Memory {
    std::uint32_t number = ~0U;
    std::uint64_t primitive = 0;
  };

  struct PairOfBodies {
    Search& search;
    const PlacedBody& a;
    const PlacedBody& b;
  };

  /// Bodies that are not compounds with surfaces.
  void run(const PlacedBody& a, const PlacedBody& b) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> bodies_near(const PlacedBody& body, const Box& box,
                                                           Room& room) noexcept;
  void parts_parts(const PlacedBody& a, const PlacedBody& b) noexcept;
  void parts_surface(const PlacedBody& parts, const PlacedBody& surface, bool mirrored) noexcept;
  [[nodiscard]] bool is_left_out(const PlacedPart& part, const Box& about,
                                 const PlacedBody& surface, std::uint32_t triangle) const noexcept;
  void mesh_mesh(const PlacedBody& a, const PlacedBody& b) noexcept;
  static void take_slots(void* context, SlotPairSink& found) noexcept;
  void surfaces(const PlacedBody& a, const PlacedBody& b) noexcept;

  [[nodiscard]] std::span<const std::uint32_t> children_near(const PlacedBody& body, const Box& box,
                                                             Room& room) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> triangles_near(const PlacedPart& part,
                                                              const PlacedBody& surface) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> triangles_near(const Box& box,
                                                              const PlacedBody& surface,
                                                              Room& room) noexcept;
  template <typename Find>
  [[nodiscard]] std::span<const std::uint32_t> collect(Room& room, Find&& find) noexcept;

  /// True if one of the triangles is one-sided and the other is behind it.
  [[nodiscard]] static bool any_is_behind(const PlacedBody& a, const Corners& of_a,
                                          const PlacedBody& b, const Corners& of_b) noexcept;

  void add(const PlacedBody& a, std::uint32_t of_a, const PlacedBody& b,
           std::uint32_t of_b) noexcept;
  [[nodiscard]] std::uint32_t primitive(const PlacedBody& body, std::uint32_t number,
                                        std::uint32_t flag) noexcept;

  const ShapeTables& tables_;
  /// Margin of the current pair of bodies.
  double margin_ = 0.0;
  WordArena& arena_;
  WordWriter primitives_;
  WordWriter pairs_;
  std::uint64_t triangles_ = 0;
  /// Number of primitives before the current pair of bodies.
  std::uint64_t before_ = 0;
  /// Recently added primitives of each body, so that few are written twice.
  std::array<Memory, kRemembered> memory_[2];
  Room outer_;
  Room inner_;
  /// Children of compounds that have surfaces.
  Room children_[2];
};

}  // namespace winnow::mid
