#include "bench/commands/arguments.h"

#include <winnow/simd/isa.h>
#include "bench/commands/command.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <thread>

namespace winnow::bench {

void add_targets_option(CLI::App& app, Choice& choice) {
  app.add_option("--scene", choice.scenes,
                 "Scenes, or recordings (.aabbs, .aabbs.xz), which have their own number of "
                 "objects (default: the six main scenes)")
      ->delimiter(',');
}

void add_objects_option(CLI::App& app, Choice& choice) {
  app.add_option("--objects", choice.objects, "Numbers of objects")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
}

void add_threads_option(CLI::App& app, Choice& choice) {
  app.add_option("--threads", choice.threads, "Numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024));
}

void add_partitions_option(CLI::App& app, Choice& choice) {
  std::vector<std::string> names = all_partitions();
  names.emplace_back("all");
  app.add_option("--partition", choice.partitions, "Partitions, or all that suit the size")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
}

void add_isa_option(CLI::App& app, Choice& choice) {
  app.add_option("--isa", choice.isa, "Instruction set (default: the widest there is)");
}

void add_seed_option(CLI::App& app, Choice& choice) {
  app.add_option("--seed", choice.seed, "What the scene is drawn from")->capture_default_str();
}

void add_frames_option(CLI::App& app, std::size_t& frames) {
  app.add_option("--frames", frames, "Frames, the first one included")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}));
}

void add_json_option(CLI::App& app, std::string& path) {
  app.add_option("--json", path, "Also write the figures to this file");
}

std::vector<int> usual_threads() {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return cores > 1 ? std::vector<int>{1, cores} : std::vector<int>{1};
}

void choose_isa(const std::string& name) {
  if (name.empty() || set_isa(name) == Status::ok) return;
  std::vector<std::string> names;
  for (const Isa isa : available_isas()) names.emplace_back(to_string(isa));
  throw ArgumentError("--isa: " + name +
                      " is not among those this machine and build have: " + listed(names));
}

}  // namespace winnow::bench
