#pragma once

// State of a Recorder, and CallWriter, with which the recorded classes write their calls.

#include <winnow/pipeline/recording.h>
#include "core/threads/mutex.h"
#include "pipeline/recording/format.h"

#include <cstdio>
#include <optional>
#include <span>

namespace winnow {

/// A recording that is being written.
struct RecorderState {
  explicit RecorderState(std::pmr::memory_resource* memory) noexcept : block(memory) {}

  /// Writes the complete calls to the file or sink.
  void flush() noexcept;
  void write(std::span<const std::byte> bytes) noexcept;
  void begin() noexcept;
  void close() noexcept;
  /// Ends the recording with an error.
  void fail(Status why) noexcept {
    if (status == Status::ok) status = why;
  }

  Mutex mutex;
  /// Locked while a scene query numbers its shape, because several threads may query one scene.
  /// Lock it before `mutex`.
  Mutex numbering;
  Column<std::byte> block;
  RecordingSink sink;
  std::FILE* file = nullptr;
  Status status = Status::ok;
  std::uint32_t worlds = 0;
  std::uint64_t calls = 0;
  std::uint64_t bytes = 0;
  bool closed = false;
};

/// Writes one call to a recording. Holds the lock of the recording during its lifetime. Writes
/// nothing if the recording has failed or is closed.
class CallWriter {
 public:
  CallWriter(RecorderState* state, RecordedCall call, std::uint32_t world) noexcept;
  ~CallWriter();
  CallWriter(const CallWriter&) = delete;
  CallWriter& operator=(const CallWriter&) = delete;

  template <PlainNumber T>
  CallWriter& put(T value) noexcept {
    if (is_open()) writer_->put(value);
    return *this;
  }
  template <typename T>
  CallWriter& put_array(std::span<const T> values) noexcept {
    if (is_open()) writer_->put_array(values);
    return *this;
  }
  CallWriter& put_text(std::string_view text) noexcept {
    if (is_open()) writer_->put_text(text);
    return *this;
  }
  CallWriter& put_bytes(const void* bytes, std::size_t count) noexcept {
    if (is_open()) writer_->put_bytes(bytes, count);
    return *this;
  }
  /// Writes the ids of keys.
  CallWriter& put_ids(std::span<const Key> keys) noexcept;
  /// Writes whether there are orientations, then an array of numbers: 7 per pose with orientations,
  /// else 3.
  CallWriter& put_poses(const PoseView& poses) noexcept {
    const bool turns = poses.has_orientations();
    put(turns).put(std::uint64_t{poses.count * (turns ? 7U : 3U)});
    for (std::size_t i = 0; i < poses.count; ++i) {
      const Pose pose = poses[i];
      put_bytes(&pose.position, sizeof pose.position);
      if (turns) put_bytes(&pose.orientation, sizeof pose.orientation);
    }
    return *this;
  }
  /// Removes the call, and ends the recording with an error.
  void give_up(Status why) noexcept;
  /// Writes a filter without its predicate.
  CallWriter& put_filter(const Filter& filter) noexcept {
    return put(filter.layers).put(filter.mask).put(filter.environment);
  }

 private:
  [[nodiscard]] bool is_open() const noexcept { return writer_.has_value(); }

  RecorderState* state_;
  Lock lock_;
  std::optional<ByteWriter> writer_;
  std::size_t begin_ = 0;
};

/// Returns the number of a new world (partition or scene); kNoWorld without a recording.
[[nodiscard]] std::uint32_t new_world(RecorderState* state) noexcept;

}  // namespace winnow
