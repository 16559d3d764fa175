#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace winnow {

/// Stages of winnow's work, for profiling. Stages nest: a query for pairs may refresh, and a
/// refresh may build. A scene with many pairs may run the last three stages more than once per
/// frame.
enum class WorkStage : std::uint8_t {
  refresh,       ///< structures are updated for changed objects
  build,         ///< a structure is rebuilt
  pairs,         ///< overlapping bounding volumes are found
  mid_phase,     ///< parts of meshes, height fields and compounds that may touch are found
  narrow_phase,  ///< pairs of shapes are tested
  contacts,      ///< results are written to Contacts
};
/// Number of stages.
inline constexpr std::size_t kWorkStages = 6;

/// Returns the enumerator's name, never null.
[[nodiscard]] WINNOW_API const char* to_string(WorkStage stage) noexcept;

/// Callback at the beginning and end of each stage, on the thread that called winnow, for profilers
/// such as Tracy or Perfetto. Stages of a thread end in the reverse order of their beginning. The
/// callback must not throw, and must not call the partition or scene that is working.
using StageHook = void (*)(WorkStage stage, bool begins);

/// Sets the stage hook of the process (null for none) and returns the previous one. Without a hook
/// a stage costs one atomic load of a pointer. Thread-safe at any time: a stage in progress ends
/// with the hook that it began with.
WINNOW_API StageHook set_stage_hook(StageHook hook) noexcept;

/// An entry that is passed to the log hook.
struct LogEntry {
  /// Kind of event.
  enum class Kind : std::uint8_t {
    choice,   ///< `automatic()` changed the structure of a partition
    refusal,  ///< a call was refused
  };
  Kind kind = Kind::refusal;  ///< determines which other members are set
  /// Name of the new structure, or of the refused call, such as "Scene::add".
  std::string_view what{};
  /// Name of the previous structure; empty for a refusal.
  std::string_view before{};
  /// Reason in a few words; for a refusal, the name of the status.
  std::string_view reason{};
  Status status = Status::ok;  ///< status of the refused call
  /// Number of objects in the partition; 0 for a refusal.
  std::size_t objects = 0;
};

/// Log callback, called on the thread that called winnow. That thread may hold locks: the callback
/// must not call the object that reports the entry. It must not throw. The entry and its text are
/// valid only during the call; names of structures, calls and statuses stay valid.
using LogHook = void (*)(const LogEntry& entry);

/// Sets the log hook of the process (null for none) and returns the previous one. Thread-safe at
/// any time.
WINNOW_API LogHook set_log_hook(LogHook hook) noexcept;

}  // namespace winnow
