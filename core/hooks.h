#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace winnow {

/// What winnow is at work on, for who wants to see where a frame's time goes. Stages nest: a query
/// for pairs may refresh, and a refresh build. A scene of many pairs goes through the last three
/// more than once in a frame.
enum class WorkStage : std::uint8_t {
  refresh,       ///< structures follow what changed
  build,         ///< a structure is made anew
  pairs,         ///< bounding volumes that overlap are found
  mid_phase,     ///< parts of meshes, height fields and compounds that may touch are found
  narrow_phase,  ///< pairs of shapes are answered
  contacts,      ///< answers are put into Contacts
};
/// How many there are.
inline constexpr std::size_t kWorkStages = 6;

/// The enumerator's name. Never null.
[[nodiscard]] WINNOW_API const char* to_string(WorkStage stage) noexcept;

/// Is called when a stage begins and when it ends, by the thread that called winnow: what a
/// profiler such as Tracy or Perfetto wants. Stages of one thread end in the reverse of the order
/// in which they began. It must not throw, nor call what called it.
using StageHook = void (*)(WorkStage stage, bool begins);

/// Sets the hook of the process, null for none, and gives back the one before. Without one a stage
/// costs a look at a pointer. At any time, from any thread: stages that are under way end with the
/// hook that they began with.
WINNOW_API StageHook set_stage_hook(StageHook hook) noexcept;

/// What a log is told.
struct LogEntry {
  /// What happened.
  enum class Kind : std::uint8_t {
    choice,   ///< the structure of a partition changed by `automatic()`
    refusal,  ///< a call of a Partition or Scene was refused
  };
  Kind kind = Kind::refusal;  ///< says which of the rest are set
  /// The structure from here on, or the call: "Scene::add".
  std::string_view what{};
  /// The structure before.
  std::string_view before{};
  /// Why, in a few words; the status by name.
  std::string_view reason{};
  Status status = Status::ok;  ///< of a refusal
  /// In the partition. 0 of a refusal.
  std::size_t objects = 0;
};

/// Is called by the thread that called winnow, which may hold locks: it must not throw, nor call
/// the partition or scene. The entry, and what it points to but names, is gone afterwards.
using LogHook = void (*)(const LogEntry& entry);

/// Sets the hook of the process, null for none, and gives back the one before. At any time, from
/// any thread.
WINNOW_API LogHook set_log_hook(LogHook hook) noexcept;

}  // namespace winnow
