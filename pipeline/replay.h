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

/// What a recording is played with.
struct ReplayOptions {
  /// Every allocation comes from here. Whoever plays what strangers recorded gives one that has a
  /// limit: a small recording may ask for many pairs.
  std::pmr::memory_resource* memory = default_memory();
  /// On whose threads; answers are the same on all.
  Execution execution = Execution::parallel();
};

/// What was played.
enum class Played : std::uint8_t {
  change,    ///< of a partition or scene
  question,  ///< whose answer was compared with the recorded one
  pairs,     ///< the same, a question for all pairs or contacts
  frame,     ///< the program's frame is over
  end,       ///< nothing: the recording is over, or `status` is not ok
};

/// Plays a recording, call by call, and compares the digest of each answer with what was recorded:
/// answers are the same, bit for bit, on every instruction set and number of threads. Anything may
/// be given as a recording: what is none is refused, by its checksums and by the calls themselves,
/// which check what they are given.
///
///     winnow::RecordingPlayer player(bytes);
///     player.play_all();
///     player.differences();
class WINNOW_API RecordingPlayer {
 public:
  /// The recording must outlive the player. Looks at the checksums of all of it: O(bytes).
  explicit RecordingPlayer(std::span<const std::byte> recording,
                           const ReplayOptions& options = {}) noexcept;
  ~RecordingPlayer();
  RecordingPlayer(const RecordingPlayer&) = delete;
  RecordingPlayer& operator=(const RecordingPlayer&) = delete;

  /// `invalid_argument` for what is no recording, or of a version that is not known, is damaged, or
  /// has a call that is refused; `out_of_memory`.
  [[nodiscard]] Status status() const noexcept;
  /// False if it ends before it was closed: the program did.
  [[nodiscard]] bool is_whole() const noexcept;

  /// Plays the next call.
  Played step() noexcept;
  /// Plays to the end; what `status` answers.
  Status play_all() noexcept;

  /// Played so far.
  [[nodiscard]] std::uint64_t calls() const noexcept;
  /// Frames that are over, of a program that told them.
  [[nodiscard]] std::uint64_t frames() const noexcept;
  /// Questions played so far.
  [[nodiscard]] std::uint64_t questions() const noexcept;
  /// Questions whose answer was another than the recorded one.
  [[nodiscard]] std::uint64_t differences() const noexcept;

  /// Partitions and scenes that were made so far, those that are gone included.
  [[nodiscard]] std::size_t worlds() const noexcept;
  /// Null if this one is a scene, or gone. `world` is below `worlds()`.
  [[nodiscard]] const Partition* partition(std::size_t world) const noexcept;
  /// Null if this one is a partition, or gone.
  [[nodiscard]] const Scene* scene(std::size_t world) const noexcept;
  /// The shapes of a scene; null where there is none.
  [[nodiscard]] const ShapePool* shapes(std::size_t world) const noexcept;
  /// Its composite shapes; null where there is none.
  [[nodiscard]] const CompositePool* composites(std::size_t world) const noexcept;
  /// What the last `collide` of a scene answered; null where there is no scene.
  [[nodiscard]] const Contacts* contacts(std::size_t world) const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null where memory was refused.
  ReplayState* state_;
};

}  // namespace winnow
