#include "tool/arguments.h"

#include "engine/partition_engine.h"
#include "scenes/scene.h"
#include "tool/command.h"
#include "tool/table.h"

#include <algorithm>
#include <thread>

namespace winnow::bench {
namespace {

template <typename Names>
std::string listed(const Names& names) {
  std::string text;
  for (const auto& name : names) {
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_infos()) names.emplace_back(info.name);
  return names;
}

}  // namespace

void add_scenes_option(CLI::App& app, Choice& choice) {
  app.add_option("--scene", choice.scenes, "Scenes (default: the six main ones)")
      ->delimiter(',')
      ->check(CLI::IsMember(scene_names()));
}

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
  std::vector<std::string> names(partition_names().begin(), partition_names().end());
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

std::vector<std::string> main_scenes() {
  std::vector<std::string> names = scene_names();
  names.resize(kMainScenes);
  return names;
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

std::unique_ptr<FrameSource> scene_or_error(const std::string& name, std::size_t objects,
                                            std::uint64_t seed) {
  auto scene = make_scene(name, objects, seed);
  if (!scene) {
    throw ArgumentError("there is no scene " + name + "; there are " + listed(scene_names()));
  }
  return scene;
}

Partitions partitions_for(const std::vector<std::string>& names, std::size_t objects) {
  Partitions result;
  const bool all = std::find(names.begin(), names.end(), "all") != names.end();
  if (!all) {
    result.taken = names;
    return result;
  }
  for (const std::string_view name : partition_names()) {
    const std::size_t largest = PartitionEngine::largest_for(name);
    if (objects <= largest) {
      result.taken.emplace_back(name);
    } else {
      result.skipped.push_back(std::string(name) + " (more than " + grouped(largest) + " objects)");
    }
  }
  return result;
}

std::vector<Contender> make_contenders(const std::vector<std::string>& partitions, int threads) {
  std::vector<Contender> contenders;
  for (const std::string& name : partitions) {
    contenders.push_back({std::make_unique<PartitionEngine>(name, threads), threads, active_isa()});
  }
  return contenders;
}

std::string skipped_line(const std::vector<std::string>& skipped) {
  return skipped.empty() ? "" : "skipped: " + listed(skipped) + "\n";
}

}  // namespace winnow::bench
