#pragma once

/// Callbacks for profilers and logs, one of each for the whole process. <winnow/core/hooks.h>
/// documents each call under the same name.

#include <winnow/c/core.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef int32_t winnow_work_stage;
enum {
  WINNOW_STAGE_REFRESH = 0,
  WINNOW_STAGE_BUILD = 1,
  WINNOW_STAGE_PAIRS = 2,
  WINNOW_STAGE_MID_PHASE = 3,
  WINNOW_STAGE_NARROW_PHASE = 4,
  WINNOW_STAGE_CONTACTS = 5
};
/// Returns the name of a stage; "unknown" for an invalid number. Never null.
WINNOW_C_API const char* winnow_work_stage_name(winnow_work_stage stage);

typedef void (*winnow_stage_hook)(winnow_work_stage stage, bool begins);
/// Sets the hook and returns the previous one; null if this call had set none before.
WINNOW_C_API winnow_stage_hook winnow_set_stage_hook(winnow_stage_hook hook);

typedef int32_t winnow_log_kind;
enum { WINNOW_LOG_CHOICE = 0, WINNOW_LOG_REFUSAL = 1 };

/// Text that is not null-terminated.
typedef struct winnow_text {
  const char* first;
  size_t count;
} winnow_text;

typedef struct winnow_log_entry {
  winnow_log_kind kind;
  winnow_text what;
  winnow_text before;
  winnow_text reason;
  winnow_status status;
  size_t objects;
} winnow_log_entry;

typedef void (*winnow_log_hook)(const winnow_log_entry* entry);
/// Sets the hook and returns the previous one; null if this call had set none before.
WINNOW_C_API winnow_log_hook winnow_set_log_hook(winnow_log_hook hook);

#ifdef __cplusplus
}
#endif
