// Generated from pipeline/interface/recording.toml; do not edit.
// clang-format off

#include <winnow/c/recording.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_recorder_create(
    const char* path, const winnow_memory* memory, winnow_recorder** recorder) {
  if (!(are_given(path, recorder))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, recorder, path);
}

void winnow_recorder_destroy(winnow_recorder* recorder) {
  destroy(recorder);
}

winnow_status winnow_recorder_end_frame(winnow_recorder* recorder) {
  if (!(are_given(recorder))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(recorder).end_frame()); });
}

winnow_status winnow_recorder_close(winnow_recorder* recorder) {
  if (!(are_given(recorder))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(recorder).close()); });
}

winnow_status winnow_recorder_status(const winnow_recorder* recorder) {
  if (!(are_given(recorder))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(recorder).status()); });
}

winnow_status winnow_recorder_bytes(const winnow_recorder* recorder, uint64_t* bytes) {
  if (!(are_given(recorder, bytes))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(recorder).bytes()); }, bytes);
}

winnow_status winnow_recorder_calls(const winnow_recorder* recorder, uint64_t* calls) {
  if (!(are_given(recorder, calls))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(recorder).calls()); }, calls);
}
