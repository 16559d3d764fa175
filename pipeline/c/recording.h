// Generated from pipeline/interface/recording.toml; do not edit.
// clang-format off
#pragma once

/// Recordings of the calls that a program makes to partitions and scenes, to be replayed elsewhere
/// and measured by `winnow replay` and `winnow advise`. Results are not changed. Failed calls are
/// not recorded. After any error the recording stops, and the program goes on.

#include <winnow/c/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Records the partitions and scenes whose options contain it, with the queries, sensors and
/// continuous collision of these scenes. It must outlive them.
typedef struct winnow_recorder winnow_recorder;

/// Creates a recorder that writes to a file, which is created or overwritten.
/// WINNOW_INVALID_ARGUMENT for a file that cannot be opened.
WINNOW_C_API winnow_status winnow_recorder_create(
    const char* path, const winnow_memory* memory, winnow_recorder** recorder);

/// Destroys the recorder; does nothing for null.
WINNOW_C_API void winnow_recorder_destroy(winnow_recorder* recorder);

/// Marks the end of a frame and writes buffered data. If a program marks no frames, tools count
/// each query for all pairs or contacts as the end of a frame.
WINNOW_C_API winnow_status winnow_recorder_end_frame(winnow_recorder* recorder);

/// Writes the end of the recording; later calls are not recorded. Returns winnow_recorder_status.
WINNOW_C_API winnow_status winnow_recorder_close(winnow_recorder* recorder);

/// Returns WINNOW_OK; WINNOW_OUT_OF_MEMORY, also if the disk is full; WINNOW_UNSUPPORTED after a
/// call that cannot be recorded: loading a partition, a shape that is one-sided or a solid or has a
/// support function, and `suppress_ghost_contacts`.
WINNOW_C_API winnow_status winnow_recorder_status(const winnow_recorder* recorder);

/// Returns the number of bytes written.
WINNOW_C_API winnow_status winnow_recorder_bytes(const winnow_recorder* recorder, uint64_t* bytes);

/// Returns the number of calls recorded.
WINNOW_C_API winnow_status winnow_recorder_calls(const winnow_recorder* recorder, uint64_t* calls);

#ifdef __cplusplus
}
#endif
