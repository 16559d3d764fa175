#pragma once

// Rules about pairs of bodies beyond sets and object filters: layers, ignored pairs and the
// caller's predicate. pair_rules.cpp implements them.

#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/pipeline/scene.h>
#include "core/memory/key_table.h"
#include "pipeline/scene/layers.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct BodyPairRules {
  explicit BodyPairRules(std::pmr::memory_resource* memory) noexcept
      : layer(memory), layers(memory), ignored(memory), ignores(memory) {}

  /// Layers of bodies, empty until a body is in a layer other than 0; and the layers that collide.
  Column<std::uint16_t> layer;
  bool with_layers = false;
  LayerMatrix layers;
  /// Pairs of bodies to ignore, as (smaller id << 32 | larger id), sorted; and by id a flag of the
  /// bodies in these pairs, with one entry for each id that existed at the last set_ignored.
  Column<std::uint64_t> ignored;
  Column<std::uint8_t> ignores;
  PairPredicate predicate;

  [[nodiscard]] bool accepts_all() const noexcept {
    return ignored.empty() && layers.all_collide() && predicate.accept == nullptr;
  }
  [[nodiscard]] bool may_pair(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] bool is_ignored(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] std::uint16_t layer_of(std::uint32_t body) const noexcept {
    return with_layers ? layer[body] : std::uint16_t{0};
  }
  /// From the first layer other than 0 on, the column has an element for every body. Returns false
  /// if memory is refused.
  [[nodiscard]] bool begin_layers(std::size_t bodies, std::size_t room) noexcept;
  /// Merges new pairs into the sorted list. Returns false if memory is refused.
  [[nodiscard]] bool add_ignored(std::span<const KeyPair> key_pairs, std::size_t bodies) noexcept;
  void remove_ignored(std::span<const KeyPair> key_pairs) noexcept;
  /// Forgets the ignored pairs of removed bodies, because new bodies may get their ids.
  void forget_ignored(std::span<const Key> removed, const KeyTable& keys) noexcept;
  /// Forgets all bodies, but not which layers collide or the predicate.
  void forget_bodies() noexcept;
  /// Exchanges everything but the predicate.
  void swap_bodies(BodyPairRules& other) noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  template <typename Unwanted>
  void drop_ignored(Unwanted&& is_unwanted) noexcept {
    std::uint64_t* const end = std::remove_if(ignored.begin(), ignored.end(), is_unwanted);
    ignored.set_size(static_cast<std::size_t>(end - ignored.begin()));
  }
};

}  // namespace winnow
