#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/table.h"
#include "bench/recordings/recording.h"
#include "bench/scenes/scene.h"

#include <iostream>

namespace winnow::bench {
namespace {

struct Record {
  std::string scene;
  std::string out;
  std::size_t objects = 10'000;
  std::size_t steps = 30;
  std::uint64_t seed = 1;

  void add_options(CLI::App& app) {
    app.add_option("scene", scene, "Name of the scene")->required();
    add_objects_option(app, objects);
    add_frames_option(app, steps, "Number of frames after the first one");
    add_seed_option(app, seed);
    app.add_option("--out", out, "File to write")->required();
  }
  [[nodiscard]] int run() const {
    const auto source = scene_or_error(scene, objects, seed);
    write_recording(out, *source, "boxes", steps);
    std::cout << out << ": " << grouped(objects) << " objects, the first frame and "
              << grouped(steps) << " more\n";
    return kDone;
  }
};

}  // namespace

void add_record(CLI::App& app) {
  command<Record>(app, "record", "Writes frames of a built-in scene to an .aabbs file");
}

}  // namespace winnow::bench
