#pragma once

#include "pipeline/composites/side.h"
#include "pipeline/composites/word_arena.h"

#include <array>
#include <cstdint>
#include <span>

namespace winnow::mid {

/// Finds the primitives of pairs of bodies that may touch: one task's search. What it finds goes to
/// an arena, as numbers within the bodies, to be written out once all tasks have counted.
class Search {
 public:
  Search(const ShapeTables& tables, double margin, WordArena& arena) noexcept;

  /// Primitives are written to `primitives()` as numbers with kSecond set for those of b, pairs to
  /// `pairs()` as two numbers of this search's primitives.
  void run(const Side& a, const Side& b) noexcept;

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

  struct PairOfSides {
    Search& search;
    const Side& a;
    const Side& b;
  };

  void parts_parts(const Side& a, const Side& b) noexcept;
  void parts_surface(const Side& parts, const Side& surface, bool swapped) noexcept;
  void mesh_mesh(const Side& a, const Side& b) noexcept;
  static void take_slots(void* context, SlotPairSink& found) noexcept;
  void surfaces(const Side& a, const Side& b) noexcept;

  [[nodiscard]] std::span<const std::uint32_t> children_near(const Side& side, const Box& box,
                                                             Room& room) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> triangles_near(const Part& part,
                                                              const Side& surface) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> triangles_near(const Box& box, const Side& surface,
                                                              Room& room) noexcept;
  template <typename Walk>
  [[nodiscard]] std::span<const std::uint32_t> collect(Room& room, Walk&& walk) noexcept;

  void add(const Side& a, std::uint32_t of_a, const Side& b, std::uint32_t of_b) noexcept;
  [[nodiscard]] std::uint32_t primitive(const Side& side, std::uint32_t number,
                                        std::uint32_t flag) noexcept;

  const ShapeTables& tables_;
  double margin_;
  WordArena& arena_;
  WordWriter primitives_;
  WordWriter pairs_;
  std::uint64_t triangles_ = 0;
  /// Primitives before those of this pair of bodies.
  std::uint64_t before_ = 0;
  /// Where a primitive was used last, so that few are written twice.
  std::array<Memory, kRemembered> memory_[2];
  Room outer_;
  Room inner_;
};

}  // namespace winnow::mid
