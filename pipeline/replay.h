#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

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

/// Replays a recording, call by call, and compares a digest of the results of each query with the
/// recorded digest. Results are the same, bit for bit, on every instruction set and for any number
/// of threads. Untrusted input is safe: invalid data is rejected by checksums and by the argument
/// checks of the calls.
///
///     winnow::RecordingPlayer player(bytes);
///     player.play_all();
///     player.differences();
class WINNOW_API RecordingPlayer {
 public:
  /// Opens a recording, which must outlive the player, and verifies all checksums: O(bytes).
  explicit RecordingPlayer(std::span<const std::byte> recording,
                           const ReplayOptions& options = {}) noexcept;
  ~RecordingPlayer();
  RecordingPlayer(const RecordingPlayer&) = delete;
  RecordingPlayer& operator=(const RecordingPlayer&) = delete;

  /// Returns `invalid_argument` if the bytes are not a recording, have an unknown version, are
  /// damaged, or contain a call that fails; `out_of_memory`; otherwise `ok`.
  [[nodiscard]] Status status() const noexcept;
  /// False if the recording was not closed, because the program ended first.
  [[nodiscard]] bool is_whole() const noexcept;

  /// Replays the next call.
  Played step() noexcept;
  /// Replays to the end. Returns `status()`.
  Status play_all() noexcept;

  /// Returns the number of calls replayed so far.
  [[nodiscard]] std::uint64_t calls() const noexcept;
  /// Returns the number of frames that ended so far, if the program marked frames.
  [[nodiscard]] std::uint64_t frames() const noexcept;
  /// Returns the number of queries replayed so far.
  [[nodiscard]] std::uint64_t questions() const noexcept;
  /// Returns the number of queries whose results differ from the recorded ones.
  [[nodiscard]] std::uint64_t differences() const noexcept;

  /// Returns the number of partitions and scenes created so far, including destroyed ones.
  [[nodiscard]] std::size_t worlds() const noexcept;
  /// Returns a partition; null if `world` is a scene or was destroyed. `world` is below `worlds()`.
  [[nodiscard]] const Partition* partition(std::size_t world) const noexcept;
  /// Returns a scene; null if `world` is a partition or was destroyed.
  [[nodiscard]] const Scene* scene(std::size_t world) const noexcept;
  /// Returns the shapes of a scene; null if there is no scene.
  [[nodiscard]] const ShapePool* shapes(std::size_t world) const noexcept;
  /// Returns the composite shapes of a scene; null if there is no scene.
  [[nodiscard]] const CompositePool* composites(std::size_t world) const noexcept;
  /// Returns the contacts of the last `collide` of a scene; null if there is no scene.
  [[nodiscard]] const Contacts* contacts(std::size_t world) const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  ReplayState* state_;
};

}  // namespace winnow
