#pragma once

// Recording of the calls that a program makes to partitions and scenes, and their replay. The
// implementation is in recording/ and replay/.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/status.h>
#include <winnow/partitions/partition.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

class CompositePool;
class Contacts;
class Scene;
class SceneObserver;
class ShapePool;
struct RecorderState;
struct SceneState;

/// Destination of a recording: a function that takes the next bytes and returns false on failure.
/// It is called by one thread at a time and must not throw.
struct RecordingSink {
  bool (*write)(void* context, std::span<const std::byte> bytes) = nullptr;  ///< null: discards
  void* context = nullptr;                                                   ///< passed to `write`
};

/// Records the calls that a program makes to partitions and scenes, to be replayed elsewhere
/// (RecordingPlayer) and measured (`winnow advise FILE`). Partitions and scenes are recorded if
/// their options contain a recorder; the SceneQueries, Sensors and ContinuousCollision of such a
/// scene are recorded, too:
///
///     winnow::Recorder recorder("run.winnow");
///     winnow::Partition partition(winnow::linear_bvh(), {.recorder = &recorder});
///     partition.insert(boxes, data, keys);
///     partition.self_pairs(pairs);
///     recorder.end_frame();
///
/// Results are not changed, and other partitions and scenes pay nothing. Failed calls are not
/// recorded, nor are calls that do not affect results, such as `reserve`. Calls from several
/// threads are recorded in the order in which they end. A query is recorded with a digest of its
/// results. pipeline/FORMATS.md has the format.
///
/// - Partitions: for a query with a predicate, its results are recorded in place of the predicate's
///   answers; a batch of rays with a predicate needs a column of keys to be recorded. An
///   incremental query, whose buffer or events contain the result of an earlier query, is replayed
///   from that result if the earlier query is one of the last 16.
/// - Scenes: the shapes of bodies, sensors and queries are recorded when they are first used, and
///   in-place changes of composite shapes with the next call. For a predicate, the pairs or bodies
///   that it accepts are recorded.
///
/// After any error the recording stops, and the program goes on. The recording ends with
/// `unsupported` on
///
/// - Partition::load, and `pairs_with` of two partitions without a common recorder;
/// - a shape that is one-sided or a solid, or has a support function;
/// - SceneOptions::suppress_ghost_contacts;
/// - a `collide` into Contacts that the scene filled, but not in its last `collide`. So use one
///   Contacts per scene; it may be cleared, filled by another scene in between, or loaded by
///   `load_contacts`.
class WINNOW_API Recorder : public PartitionRecorder {
 public:
  /// Records to a file, which is created or overwritten. `memory` must outlive the recorder.
  explicit Recorder(const char* path,
                    std::pmr::memory_resource* memory = default_memory()) noexcept;
  /// Records to a sink.
  explicit Recorder(const RecordingSink& sink,
                    std::pmr::memory_resource* memory = default_memory()) noexcept;
  /// Closes the recording. Recorded objects must be destroyed first.
  virtual ~Recorder();
  Recorder& operator=(Recorder&&) = delete;  // neither copied nor moved

  /// Marks the end of a frame and writes buffered data. If a program marks no frames, tools count
  /// each query for all pairs or contacts as the end of a frame.
  void end_frame() noexcept;
  /// Writes the end of the recording; later calls are not recorded. Returns `status()`.
  Status close() noexcept;

  /// Returns `ok`; `out_of_memory`, also if the sink fails or the disk is full; `invalid_argument`
  /// for a file that cannot be opened; `unsupported` after a call that cannot be recorded.
  [[nodiscard]] Status status() const noexcept;
  /// Returns the number of bytes written.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Returns the number of calls recorded.
  [[nodiscard]] std::uint64_t calls() const noexcept;

 private:
  friend class Scene;
  [[nodiscard]] PartitionObserver* observe_partition(
      StructureKind structure, const PartitionOptions& options) noexcept override;
  /// Returns the observer of a new scene; null if its calls cannot be recorded. Virtual, so that a
  /// program without a Recorder does not link its code.
  [[nodiscard]] virtual SceneObserver* observe_scene(SceneState& scene) noexcept;

  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  RecorderState* state_;
};

struct ReplayState;

/// Options of a replay.
struct ReplayOptions {
  /// Source of every allocation. For untrusted recordings, use a resource with a limit: a small
  /// recording may generate many pairs.
  std::pmr::memory_resource* memory = default_memory();
  /// How work is run in parallel; results do not depend on it.
  Execution execution = Execution::parallel();
};

/// Kind of a replayed call.
enum class Played : std::uint8_t {
  change,    ///< a change of a partition or scene
  question,  ///< a query; its results were compared with the recorded ones
  pairs,     ///< as `question`, for all pairs or contacts
  frame,     ///< the end of a frame of the program
  end,       ///< nothing: the recording has ended, or `status` is not ok
};

/// Counters of a replay.
struct PlayedCounts {
  std::uint64_t calls = 0;        ///< calls replayed
  std::uint64_t frames = 0;       ///< frames that ended, if the program marked frames
  std::uint64_t questions = 0;    ///< queries replayed
  std::uint64_t differences = 0;  ///< queries whose results differ from the recorded ones
};

/// A partition or a scene of a replay.
struct PlayedWorld {
  const Partition* partition = nullptr;       ///< null for a scene
  const Scene* scene = nullptr;               ///< null for a partition
  const ShapePool* shapes = nullptr;          ///< convex shapes of the scene
  const CompositePool* composites = nullptr;  ///< composite shapes of the scene
  const Contacts* contacts = nullptr;         ///< contacts of the last `collide` of the scene
};

/// Replays a recording, call by call, and compares a digest of the results of each query with the
/// recorded digest. Results are the same, bit for bit, on every instruction set and for any number
/// of threads. Untrusted input is safe: invalid data is rejected by checksums and by the argument
/// checks of the calls.
///
///     winnow::RecordingPlayer player(bytes);
///     player.play_all();
///     player.counts().differences;
class WINNOW_API RecordingPlayer {
 public:
  /// Opens a recording, which must outlive the player, and verifies all checksums: O(bytes).
  explicit RecordingPlayer(std::span<const std::byte> recording,
                           const ReplayOptions& options = {}) noexcept;
  ~RecordingPlayer();
  RecordingPlayer& operator=(RecordingPlayer&&) = delete;  // neither copied nor moved

  /// Returns `invalid_argument` if the bytes are not a recording, have an unknown version, are
  /// damaged, or contain a call that fails; `out_of_memory`; otherwise `ok`.
  [[nodiscard]] Status status() const noexcept;
  /// False if the recording was not closed, because the program ended first.
  [[nodiscard]] bool is_whole() const noexcept;

  /// Replays the next call.
  Played step() noexcept;
  /// Replays to the end. Returns `status()`.
  Status play_all() noexcept;

  /// Returns what was replayed so far.
  [[nodiscard]] PlayedCounts counts() const noexcept;

  /// Returns the number of partitions and scenes created so far, including destroyed ones.
  [[nodiscard]] std::size_t worlds() const noexcept;
  /// Returns the partition or the scene with this number, which is below `worlds()`; all null if it
  /// was destroyed.
  [[nodiscard]] PlayedWorld world(std::size_t number) const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  ReplayState* state_;
};

}  // namespace winnow
