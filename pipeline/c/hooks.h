#pragma once

/// What profilers and logs are told, of all that runs in a process. What each call does stands at
/// the same name of <winnow/core/hooks.h>.

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
/// Never null: "unknown" for a number that is none.
WINNOW_C_API const char* winnow_work_stage_name(winnow_work_stage stage);

typedef void (*winnow_stage_hook)(winnow_work_stage stage, bool begins);
/// Gives back the one before, null if there was none that was set here.
WINNOW_C_API winnow_stage_hook winnow_set_stage_hook(winnow_stage_hook hook);

typedef int32_t winnow_log_kind;
enum { WINNOW_LOG_CHOICE = 0, WINNOW_LOG_REFUSAL = 1 };

/// Characters that no zero ends.
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
/// Gives back the one before, null if there was none that was set here.
WINNOW_C_API winnow_log_hook winnow_set_log_hook(winnow_log_hook hook);

#ifdef __cplusplus
}
#endif
