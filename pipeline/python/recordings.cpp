// Recorder and replay: recordings of calls.

#include "pipeline/python/recordings.h"

#include "pipeline/python/bytes.h"
#include "pipeline/python/callbacks.h"
#include "pipeline/python/refusal.h"

#include <winnow/pipeline/recording.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace winnow::python {
namespace {

/// Encodes a path for the file system.
[[nodiscard]] std::string file_name(const py::object& path) {
  const py::object name = py::module_::import("os").attr("fsencode")(path);
  const auto bytes = py::cast<std::string>(name);
  if (bytes.find('\0') != std::string::npos) {
    throw Refusal(Status::invalid_argument, "path: there is a NUL in it");
  }
  return bytes;
}

[[nodiscard]] RecorderPointer make_recorder(const py::object& path) {
  auto recorder = std::make_shared<SharedRecorder>(file_name(path).c_str());
  accept(recorder->recorder.status(), "Recorder: " + py::cast<std::string>(py::repr(path)));
  return recorder;
}

void close(SharedRecorder& r) {
  InCallback::forbid();
  const auto closed = [&] {
    const WithoutGil release;
    return r.recorder.close();
  };
  accept(closed(), "close");
}

/// Result of a replay.
struct ReplayCounts {
  Status status = Status::ok;
  std::uint64_t calls = 0;
  std::uint64_t frames = 0;
  std::uint64_t questions = 0;
  std::uint64_t differences = 0;
  std::size_t worlds = 0;
  bool is_whole = false;
};

[[nodiscard]] ReplayCounts play(std::span<const std::byte> bytes, const Execution& execution) {
  const WithoutGil release;
  RecordingPlayer player(bytes, {.execution = execution});
  ReplayCounts played;
  played.status = player.play_all();
  played.calls = player.counts().calls;
  played.frames = player.counts().frames;
  played.questions = player.counts().questions;
  played.differences = player.counts().differences;
  played.worlds = player.worlds();
  played.is_whole = player.is_whole();
  return played;
}

[[nodiscard]] py::dict replay(const py::buffer& data, bool parallel) {
  const BytesInput input(data);
  const ReplayCounts played =
      play(input.bytes(), parallel ? Execution::parallel() : Execution::serial());
  accept(played.status, "replay, call " + std::to_string(played.calls));
  return py::dict(py::arg("calls") = played.calls, py::arg("frames") = played.frames,
                  py::arg("questions") = played.questions,
                  py::arg("differences") = played.differences, py::arg("worlds") = played.worlds,
                  py::arg("is_whole") = played.is_whole);
}

}  // namespace

void add_recordings(py::module_& module) {
  Class<SharedRecorder>(module, "Recorder")
      .def(py::init(&make_recorder))
      .def("end_frame",
           [](SharedRecorder& r) {
             InCallback::forbid();
             const WithoutGil release;
             r.recorder.end_frame();
           })
      .def("close", &close)
      .property("status", [](const SharedRecorder& r) { return to_string(r.recorder.status()); })
      .property("calls", [](const SharedRecorder& r) { return r.recorder.calls(); })
      .property("bytes", [](const SharedRecorder& r) { return r.recorder.bytes(); });
  add_function(module, "replay", &replay);
}

}  // namespace winnow::python
