#pragma once

#include "pipeline/python/described.h"
#include "pipeline/python/init_checks.h"

#include <winnow/pipeline/recording.h>

#include <memory>

namespace winnow::python {

/// A recorder, kept alive by the objects that it records. Its calls may come from any thread.
struct SharedRecorder : NeedsInit {
  explicit SharedRecorder(const char* path) : recorder(path) {}
  Recorder recorder;
};
/// Null if there is no recorder.
using RecorderPointer = std::shared_ptr<SharedRecorder>;

/// Returns options with this recorder.
template <typename Options>
[[nodiscard]] Options recorded_by(const RecorderPointer& recorder, Options options) {
  options.recorder = recorder ? &recorder->recorder : nullptr;
  return options;
}

/// Adds Recorder and replay.
void add_recordings(py::module_& module);

}  // namespace winnow::python
