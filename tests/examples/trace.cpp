// Writes the stages of a scene as a trace for chrome://tracing, ui.perfetto.dev and the import of
// Tracy, and the messages of winnow as a log. Usage: trace FILE

#include <winnow/winnow.h>

#include <chrono>
#include <cstdio>
#include <mutex>
#include <random>
#include <string_view>
#include <vector>

#include "tests/examples/check.h"

namespace {

/// Events in the format of Chrome's trace viewer, one line each.
class Trace {
 public:
  explicit Trace(const char* file) : file_(std::fopen(file, "w")) {
    check(file_ != nullptr, "the file can be written");
    std::fprintf(file_, "[");
  }
  ~Trace() {
    std::fprintf(file_, "\n]\n");
    std::fclose(file_);
  }
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  void note(winnow::WorkStage stage, bool begins) {
    const std::chrono::duration<double, std::micro> at = std::chrono::steady_clock::now() - start_;
    const std::lock_guard lock(mutex_);
    std::fprintf(file_, R"(%s{"name":"%s","ph":"%s","ts":%.3f,"pid":0,"tid":0})",
                 events_++ == 0 ? "\n" : ",\n", winnow::to_string(stage), begins ? "B" : "E",
                 at.count());
  }

 private:
  std::FILE* file_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::size_t events_ = 0;
};

Trace* trace = nullptr;

void log(const winnow::LogEntry& entry) {
  const auto show = [](std::string_view text) { return static_cast<int>(text.size()); };
  std::printf("%.*s: %.*s\n", show(entry.what), entry.what.data(), show(entry.reason),
              entry.reason.data());
}

}  // namespace

int main(int argc, char** argv) {
  check(argc == 2, "a file is named");
  Trace file(argv[1]);
  trace = &file;
  winnow::set_stage_hook([](winnow::WorkStage stage, bool begins) { trace->note(stage, begins); });
  winnow::set_log_hook(log);

  winnow::ShapePool shapes;
  const winnow::ShapeId ball = shapes.add(winnow::SphereShape{0.5});
  const winnow::StructureKind any = winnow::automatic();
  winnow::Scene scene(shapes, {.structures = {any, any, any}});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0.0, 20.0);
  std::vector<winnow::Key> keys(5'000);
  for (winnow::Key& key : keys) {
    key = scene.add(
        {.shape = ball, .pose = winnow::Pose::at(place(random), place(random), place(random))});
  }
  check(!scene.add({}), "a body without a shape is refused");
  winnow::Contacts contacts;
  for (int frame = 0; frame < 5; ++frame) {
    for (const winnow::Key key : keys) {
      must(scene.move(key, winnow::Pose::at(place(random), place(random), place(random))));
    }
    must(scene.collide(winnow::ContactLevel::manifold, contacts));
  }
  check(contacts.size() != 0, "some touch");
  winnow::set_stage_hook(nullptr);
  winnow::set_log_hook(nullptr);
}
