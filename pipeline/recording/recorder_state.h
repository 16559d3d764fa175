#pragma once

// State of a Recorder, and CallWriter, with which the observers of partitions and scenes write
// their calls.

#include <winnow/core/pose.h>
#include <winnow/pipeline/recording.h>
#include "core/memory/new_in.h"
#include "core/threads/mutex.h"
#include "pipeline/recording/format.h"

#include <cstdio>
#include <optional>
#include <span>
#include <utility>

namespace winnow {

/// A recording that is being written.
struct RecorderState {
  explicit RecorderState(std::pmr::memory_resource* memory) noexcept : block(memory) {}

  /// Writes the complete calls to the file or sink.
  void flush() noexcept;
  void write(std::span<const std::byte> bytes) noexcept;
  void begin() noexcept;
  void close() noexcept;
  /// Ends the recording with an error. The caller holds the mutex.
  void fail(Status why) noexcept {
    if (status == Status::ok) status = why;
  }
  /// As `fail`, and locks the mutex.
  void stop(Status why) noexcept {
    const Lock lock(mutex);
    fail(why);
  }

  /// Creates the observer of a new world (partition or scene), with the number of the world as its
  /// second argument. Null if memory is refused, which ends the recording.
  template <typename Observer, typename... Arguments>
  [[nodiscard]] Observer* make_world(Arguments&&... arguments) noexcept {
    const Lock lock(mutex);
    auto* const made =
        new_in<Observer>(block.memory(), *this, worlds++, std::forward<Arguments>(arguments)...);
    if (made == nullptr) fail(Status::out_of_memory);
    return made;
  }
  /// Destroys an observer, which frees its memory.
  template <typename Observer>
  void destroy(Observer* observer) noexcept {
    const Lock lock(mutex);
    delete_in(block.memory(), observer);
  }

  /// Also locked while the memory resource is used.
  Mutex mutex;
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
  CallWriter(RecorderState& state, RecordedCall call, std::uint32_t world) noexcept;
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
  CallWriter& put_filter(const ObjectFilter& filter) noexcept {
    return put(filter.layers).put(filter.mask).put(filter.environment);
  }

 private:
  [[nodiscard]] bool is_open() const noexcept { return writer_.has_value(); }

  RecorderState& state_;
  const Lock lock_;
  std::optional<ByteWriter> writer_;
  std::size_t begin_ = 0;
};

}  // namespace winnow
