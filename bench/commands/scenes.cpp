#include "bench/commands/command.h"
#include "bench/common/table.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/scenes/scene.h"

#include <iostream>

namespace winnow::bench {
namespace {

constexpr std::size_t kObjects = 10'000;

double pairs_an_object(std::string_view scene) {
  const auto source = make_scene(scene, kObjects, 1);
  ReferenceSweep sweep(-1);
  sweep.start(source->boxes());
  return static_cast<double>(sweep.pairs().size()) / static_cast<double>(kObjects);
}

void print_scenes() {
  Table table({"scene", "pairs an object", "description"});
  table.flush_left(2);
  for (const SceneInfo& info : scene_infos()) {
    table.add(
        {std::string(info.name), short_number(pairs_an_object(info.name)), std::string(info.what)});
  }
  std::cout << table << "pairs measured in the first frame of " << grouped(kObjects)
            << " objects (N). Unless stated otherwise,\n"
            << "speeds are up to 5 % of the edge per frame and axis; objects are reflected at the "
               "walls.\n";
}

}  // namespace

void add_scenes(CLI::App& app) {
  app.add_subcommand("scenes", "Lists the built-in scenes")->callback(print_scenes);
}

}  // namespace winnow::bench
