#include "bench/commands/options.h"

#include <winnow/simd/isa.h>
#include "bench/common/errors.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <thread>

namespace winnow::bench {

void add_partitions_option(CLI::App& app, std::vector<std::string>& partitions) {
  std::vector<std::string> names = all_partitions();
  names.emplace_back("all");
  one_of(app, "--partition", partitions, names,
         "Partitions, or `all` that suit the number of objects");
}

void add_isa_option(CLI::App& app, std::string& isa) {
  option(app, "--isa", isa, "Instruction set (default: the widest one available)");
}

void add_seed_option(CLI::App& app, std::uint64_t& seed) {
  option(app, "--seed", seed, "Seed of the random scene");
}

void add_json_option(CLI::App& app, std::string& path) {
  option(app, "--json", path, "Also write the results to this file as JSON");
}

std::vector<int> usual_threads() {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return cores > 1 ? std::vector<int>{1, cores} : std::vector<int>{1};
}

void choose_isa(const std::string& name) {
  if (name.empty() || set_isa(name) == Status::ok) return;
  throw ArgumentError(
      "--isa: " + name +
      " is not available in this build or on this machine; available: " + listed(isa_names()));
}

void Target::add_to(CLI::App& app) {
  app.add_option(
         "target", name,
         "Name of a scene, or file of a recording (.aabbs or .winnow, also compressed as .xz)")
      ->required();
  add_objects_option(app, objects, "Number of objects of the scene (10000)");
  app.add_option("--seed", seed, "Seed of the random scene (1)");
}

NamedScene Target::named() const {
  NamedScene scene = named_scenes({name}).front();
  if (scene.is_recording() && (objects || seed)) {
    throw ArgumentError("--objects and --seed need the name of a scene, and " + name +
                        " is not one (see: winnow scenes)");
  }
  return scene;
}

}  // namespace winnow::bench
