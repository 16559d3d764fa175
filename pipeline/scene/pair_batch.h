#pragma once

// The pairs of one batch of Scene::collide that need new contacts, and their results.

#include <winnow/pipeline/narrow_phase.h>
#include "core/memory/new_in.h"
#include "pipeline/composites/mid_phase.h"
#include "pipeline/scene/ghost_contacts.h"

#include <cstdint>
#include <memory_resource>

namespace winnow {

struct SceneCapacity;
struct SceneOptions;

/// Input and results of the mid and narrow phase for pairs that have a composite shape.
struct PartAnswers {
  explicit PartAnswers(std::pmr::memory_resource* memory) noexcept
      : pairs(memory),
        gaps(memory),
        narrow(memory),
        answers(memory),
        slot(memory),
        regions(memory) {}

  PrimitivePairs pairs;
  /// Contact distance of the two bodies, by pair of primitives. Empty without offsets.
  Column<double> gaps;
  NarrowPhase narrow;
  NarrowResult answers;
  /// Index of the result in `answers`, by pair of primitives.
  Column<std::uint32_t> slot;
  ContactRegions regions;

  [[nodiscard]] Bytes bytes() const noexcept;
};

/// Pairs that go to the narrow phase, with its state and results.
struct PairBatch {
  explicit PairBatch(std::pmr::memory_resource* memory) noexcept
      : narrow(memory),
        answers(memory),
        convex(memory),
        composite(memory),
        gaps(memory),
        floor_contacts(memory),
        floor_order(memory) {}
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;
  ~PairBatch() { delete_in(convex.memory(), parts); }

  NarrowPhase narrow;
  NarrowResult answers;
  /// Pairs of convex shapes, and pairs that have a composite shape.
  Column<BodyPair> convex;
  Column<BodyPair> composite;
  /// Contact distance by pair of `convex` or of `composite`, whichever list the narrow phase works
  /// on. Empty without offsets.
  Column<double> gaps;
  /// Results for `composite`; created for the first such pair.
  PartAnswers* parts = nullptr;
  /// Used only with SceneOptions::suppress_ghost_contacts.
  Column<FloorContact> floor_contacts;
  /// Scratch: the order of one body's floor contacts.
  Column<std::uint32_t> floor_order;

  /// Implements Scene::reserve (reserve.cpp).
  [[nodiscard]] Status reserve(const ShapePool& shapes, const SceneOptions& options,
                               const SceneCapacity& room, bool with_offsets, Pages pages);

 private:
  [[nodiscard]] bool list_rehearsal(std::size_t kinds, std::size_t count) noexcept;
};

}  // namespace winnow
