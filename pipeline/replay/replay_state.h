#pragma once

// State of a RecordingPlayer: the partitions and scenes that it plays, and the memory into which
// calls are read. Each play_*.cpp file implements one group of calls.

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include "core/memory/new_in.h"
#include "pipeline/replay/call_reader.h"

#include <array>
#include <optional>

namespace winnow {

/// Result of a pair query, which a later query may update.
struct ReplayedPairs {
  explicit ReplayedPairs(std::pmr::memory_resource* memory) noexcept
      : pairs(memory), events(memory) {}

  PairBuffer pairs;
  PairEvents events;
  std::uint64_t number = 0;  // number of the query; 0: none
};

/// Sensors of a scene in a recording.
struct ReplayedSensors {
  ReplayedSensors(Scene& scene, std::pmr::memory_resource* memory) noexcept
      : sensors(scene, memory), keys(memory) {}

  Sensors sensors;
  Column<Key> keys;  // by id
};

/// A partition or scene of a recording, with buffers for the results of its queries.
struct ReplayedWorld {
  static constexpr std::size_t kPairHistory = 16;
  template <std::size_t... I>
  [[nodiscard]] static std::array<ReplayedPairs, kPairHistory> make_pair_results(
      std::pmr::memory_resource* memory, std::index_sequence<I...>) noexcept {
    return {((void)I, ReplayedPairs(memory))...};
  }

  explicit ReplayedWorld(std::pmr::memory_resource* memory) noexcept
      : pair_results(make_pair_results(memory, std::make_index_sequence<kPairHistory>{})),
        other_pairs(memory),
        hits(memory),
        objects(memory),
        shape_ids(memory),
        passed(memory),
        contacts(memory),
        sensors(memory) {}
  ~ReplayedWorld() {
    for (ReplayedSensors* const one : sensors) delete_in(sensors.memory(), one);
  }
  ReplayedWorld(const ReplayedWorld&) = delete;
  ReplayedWorld& operator=(const ReplayedWorld&) = delete;

  std::optional<Partition> partition;
  std::array<ReplayedPairs, kPairHistory> pair_results;  // the results with the highest numbers
  std::uint64_t pair_queries = 0;                        // number of pair queries
  PairBuffer other_pairs;
  HitBuffer hits;
  OverlapBuffer objects;

  std::optional<ShapePool> shapes;
  std::optional<CompositePool> composites;
  std::optional<Scene> scene;
  std::optional<SceneQueries> queries;
  Column<ShapeId> shape_ids;  // indexed by number in the recording
  Column<Pair> passed;        // pairs that the predicate accepts in the next query; sorted
  Contacts contacts;
  std::optional<ContinuousCollision> ccd;
  Column<ReplayedSensors*> sensors;  // indexed by number; null if destroyed
};

/// Kind of a call.
enum class CallOutcome : std::uint8_t { changed, frame };

/// State of a player.
struct ReplayState {
  ReplayState(std::span<const std::byte> bytes, const ReplayOptions& given) noexcept;
  ~ReplayState();

  [[nodiscard]] Status check() noexcept;
  [[nodiscard]] bool next_block() noexcept;
  [[nodiscard]] Played step() noexcept;
  [[nodiscard]] Status play(RecordedCall call, std::uint32_t number, CallOutcome& outcome);
  [[nodiscard]] Status play_world(RecordedCall call, std::uint32_t number);
  [[nodiscard]] ReplayedWorld* world(std::uint32_t number) const noexcept {
    return number < worlds.size() ? worlds[number] : nullptr;
  }
  [[nodiscard]] ReplayedWorld* add_world(std::uint32_t number) noexcept;
  [[nodiscard]] static SceneState* state_of(Scene& scene) noexcept { return scene.state_; }

  // Reads of arguments that several groups of calls have.

  /// Reads ids into `ids` and looks up their keys. Ids without a live object become null keys,
  /// which every call refuses.
  template <typename Owner>
  [[nodiscard]] bool read_keys(const Owner& of) {
    if (!in.get_array(ids)) return false;
    if (!keys.resize(ids.size())) return in.refuse_memory();
    for (std::size_t i = 0; i < ids.size(); ++i) keys[i] = of.key_of(ids[i]);
    return true;
  }
  /// Reads two sets of bodies into `others` and `keys`.
  [[nodiscard]] bool read_sets(ReplayedWorld& of);
  [[nodiscard]] std::span<const Key> first_set() const noexcept {
    return {others.data(), others.size()};
  }
  [[nodiscard]] std::span<const Key> second_set() const noexcept {
    return {keys.data(), keys.size()};
  }
  [[nodiscard]] bool read_poses(std::size_t count, PoseView& poses);
  [[nodiscard]] bool read_shape(const ReplayedWorld& of, ShapeId& id) noexcept;
  /// Reads the filter at the end of a query; false if it is incomplete.
  [[nodiscard]] bool read_query_filter() noexcept;

  /// Compares the digest of the results with the recorded digest.
  template <typename... Answer>
  [[nodiscard]] Status compare(const Answer&... answer) noexcept {
    return compare(digest_of_answers(answer...));
  }
  /// As above if the query succeeded; returns its status otherwise.
  template <typename... Answer>
  [[nodiscard]] Status compare_if(Status answered, const Answer&... answer) noexcept {
    return answered == Status::ok ? compare(answer...) : answered;
  }
  template <typename T>
  [[nodiscard]] Status compare_if(const Answer<T>& answer) noexcept {
    return answer.status == Status::ok ? compare(digest_of_answers(answer)) : answer.status;
  }
  [[nodiscard]] Status compare(const Digest& digest) noexcept { return compare(digest.value()); }
  [[nodiscard]] Status compare(std::uint64_t digest) noexcept {
    const auto recorded = in.get<std::uint64_t>();
    ++queries;
    if (recorded != digest) ++differences;
    return status_of(in);
  }

  ReplayOptions options;
  std::span<const std::byte> rest;  // blocks that have not been started
  ByteReader in;                    // the current block
  Status status = Status::ok;
  RecordedCall last_call = RecordedCall::end_frame;  // last call of the recording's version
  bool is_whole = false;
  std::uint64_t calls = 0;
  std::uint64_t frames = 0;
  std::uint64_t queries = 0;
  std::uint64_t differences = 0;
  Column<ReplayedWorld*> worlds;

  // Buffers into which calls are read.
  Column<ObjectId> ids;
  Column<Key> keys;
  Column<Key> others;
  Column<ClientData> data;
  Column<float> floats;
  Column<double> doubles;
  Column<ObjectFilter> filters;
  Column<RecordedBody> recorded_bodies;
  Column<BodyDefinition> bodies;
  Column<KeyPair> key_pairs;
  Column<Ray> rays;
  Column<ShapeRay> shape_rays;
  Column<Plane> planes;
  Column<RigidMotion> motions;
  Column<std::uint8_t> flags;
  RecordedFilter filter;
};

// These functions play one group of calls each; the rest of the call is read from `replay.in`.
[[nodiscard]] Status change_partition(ReplayState& replay, RecordedCall call, ReplayedWorld& of);
[[nodiscard]] Status make_scene(ReplayState& replay, ReplayedWorld& of);
[[nodiscard]] Status change_scene(ReplayState& replay, RecordedCall call, ReplayedWorld& of);
[[nodiscard]] Status play_sensors(ReplayState& replay, RecordedCall call, ReplayedWorld& of);
[[nodiscard]] Status find_impacts(ReplayState& replay, RecordedCall call, ReplayedWorld& of);
[[nodiscard]] Status query_scene(ReplayState& replay, RecordedCall call, ReplayedWorld& of);

}  // namespace winnow
