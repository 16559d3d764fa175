#include "bench/commands/target.h"

#include "bench/common/errors.h"

namespace winnow::bench {

void Target::add_to(CLI::App& app) {
  app.add_option("target", name, "A recording (.aabbs, .aabbs.xz) or a scene's name")->required();
  app.add_option("--objects", objects, "Number of objects of a scene (10000)")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
  app.add_option("--seed", seed, "What a scene is drawn from (1)");
}

NamedScene Target::named() const {
  NamedScene scene = named_scenes({name}).front();
  if (scene.is_recording() && (objects || seed)) {
    throw ArgumentError("--objects and --seed go with the name of a scene, and " + name +
                        " is not one (see: winnow scenes)");
  }
  return scene;
}

}  // namespace winnow::bench
