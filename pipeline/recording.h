#pragma once

// Recording of the calls that a program makes to partitions and scenes. RecordingPlayer (replay.h)
// replays the result. The implementation is in recording/.

#include <winnow/core/export.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/partitions/partition.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

class SceneObserver;
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
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

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

}  // namespace winnow
