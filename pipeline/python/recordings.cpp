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
  py::dict result;
  result["calls"] = played.calls;
  result["frames"] = played.frames;
  result["questions"] = played.questions;
  result["differences"] = played.differences;
  result["worlds"] = played.worlds;
  result["is_whole"] = played.is_whole;
  return result;
}

}  // namespace

void add_recordings(py::module_& module) {
  using py::arg;
  py::class_<SharedRecorder, RecorderPointer>(
      module, "Recorder",
      "Records the calls of partitions and scenes that are made with it, so that they can be "
      "replayed and measured elsewhere: `winnow advise FILE`. Failed calls are not recorded. "
      "Recorded partitions cannot load snapshots (unsupported). A recorded scene must be used with "
      "one Contacts, which may be loaded: `status` is 'unsupported' after one that was filled in "
      "an earlier call than the last. If anything fails, the recording ends and the program "
      "continues: see `status`.")
      .def(
          py::init(&make_recorder), arg("path"),
          "Records into the file at a path, as `open` accepts it, which is created or overwritten.")
      .def(
          "end_frame",
          [](SharedRecorder& r) {
            InCallback::forbid();
            const WithoutGil release;
            r.recorder.end_frame();
          },
          "Marks the end of a frame, and writes buffered data.")
      .def("close", &close, "Ends the recording. Raises the error that occurred, if any.")
      .def_property_readonly(
          "status", [](const SharedRecorder& r) { return to_string(r.recorder.status()); },
          "'ok'; 'out_of_memory', also if the disk is full; 'unsupported' after a call that cannot "
          "be recorded.")
      .def_property_readonly(
          "calls", [](const SharedRecorder& r) { return r.recorder.calls(); },
          "Number of calls recorded.")
      .def_property_readonly(
          "bytes", [](const SharedRecorder& r) { return r.recorder.bytes(); }, "Bytes written.");
  module.def("replay", &replay, arg("data"), arg("parallel") = true,
             "Replays a recording, the bytes of a file, and compares each result with the recorded "
             "one, bit for bit: counts of calls, frames, questions, differences and worlds "
             "(partitions and scenes), and is_whole if the recording is complete. invalid_argument "
             "for bytes that are not a valid recording.");
}

}  // namespace winnow::python
