// Generated from pipeline/interface/hooks.toml; do not edit.
// clang-format off
#pragma once

/// Callbacks for profilers and logs, one of each for the whole process. Setting one is thread-safe
/// at any time.

#include <winnow/c/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Stages of winnow's work. Stages nest: a query for pairs may refresh, and a refresh may build. A
/// scene with many pairs may run the last three stages more than once per frame.
typedef int32_t winnow_work_stage;
enum {
  WINNOW_STAGE_REFRESH = 0,  ///< structures are updated for changed objects
  WINNOW_STAGE_BUILD = 1,    ///< a structure is rebuilt
  WINNOW_STAGE_PAIRS = 2,    ///< overlapping bounding volumes are found
  /// Parts of meshes, height fields and compounds that may touch are found.
  WINNOW_STAGE_MID_PHASE = 3,
  WINNOW_STAGE_NARROW_PHASE = 4,  ///< pairs of shapes are tested
  WINNOW_STAGE_CONTACTS = 5       ///< results are written to winnow_contacts
};

/// Kind of a log entry.
typedef int32_t winnow_log_kind;
enum {
  WINNOW_LOG_CHOICE = 0,  ///< `automatic` changed the structure of a partition
  WINNOW_LOG_REFUSAL = 1  ///< a call was refused
};

/// Called at the beginning and the end of each stage, on the thread that called winnow. Stages of a
/// thread end in the reverse order of their beginning.
typedef void (*winnow_stage_hook)(winnow_work_stage stage, bool begins);

/// Called on the thread that called winnow. That thread may hold locks: the callback must not call
/// the object that reports the entry. The entry and its text are valid only during the call.
struct winnow_log_entry;
typedef void (*winnow_log_hook)(const struct winnow_log_entry* entry);

/// Text that is not null-terminated.
typedef struct winnow_text {
  const char* first;  ///< its first character
  size_t count;       ///< number of characters
} winnow_text;

/// An entry that is passed to the log hook.
typedef struct winnow_log_entry {
  winnow_log_kind kind;  ///< determines which other members are set
  winnow_text what;      ///< name of the new structure, or of the refused call, such as Scene::add
  winnow_text before;    ///< name of the previous structure; empty for a refusal
  winnow_text reason;    ///< reason in a few words; for a refusal, the name of the status
  winnow_status status;  ///< status of the refused call
  size_t objects;        ///< number of objects in the partition; 0 for a refusal
} winnow_log_entry;

/// Returns the name of a stage; "unknown" for an invalid number. Never null.
WINNOW_C_API const char* winnow_work_stage_name(winnow_work_stage stage);

/// Sets the hook (null for none) and returns the previous one; null if this call had set none
/// before. A stage in progress ends with the hook that it began with.
WINNOW_C_API winnow_stage_hook winnow_set_stage_hook(winnow_stage_hook hook);

/// Sets the hook (null for none) and returns the previous one; null if this call had set none
/// before.
WINNOW_C_API winnow_log_hook winnow_set_log_hook(winnow_log_hook hook);

#ifdef __cplusplus
}
#endif
