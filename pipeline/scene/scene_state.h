#pragma once

#include <winnow/core/key_table.h>
#include <winnow/pipeline/scene.h>

#include <memory>

namespace winnow {

/// One set of bodies and its partition, made when its first body comes.
struct SceneSet {
  explicit SceneSet(std::pmr::memory_resource* memory) noexcept
      : body_of(memory), within(memory), across(memory) {}

  std::unique_ptr<Partition> partition;
  std::size_t bodies = 0;
  /// By the partition's object id.
  Column<std::uint32_t> body_of;
  /// Dynamic: its own pairs. The others: pairs of dynamic bodies with them.
  PairBuffer within;
  PairBuffer across;
};

/// What a Scene consists of. Bodies are numbered by the ids of their keys; columns are by id and
/// have holes where bodies were removed.
struct Scene::State {
  State(const ShapePool& pool, const SceneOptions& given);

  const ShapePool& shapes;
  SceneOptions options;
  bool options_are_good;

  KeyTable keys;
  Column<ShapeId> shape;
  Column<Pose> pose;
  Column<Motion> motion;
  /// Of the body in the partition of its set.
  Column<Key> place;
  /// Bodies whose boxes may no longer be right: their ids, and a flag by id.
  Column<std::uint32_t> stale;
  Column<std::uint8_t> is_stale;

  SceneSet sets[kMotions];

  [[nodiscard]] bool is_fresh() const noexcept { return stale.empty(); }
};

}  // namespace winnow
