#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <winnow/partitions/partition.h>

#include <cmath>
#include <iostream>
#include <optional>

namespace winnow::bench {
namespace {

constexpr std::string_view kBaseline = "BoundsNSquared";
constexpr std::size_t kSmallest = 16;
constexpr std::size_t kLargest = 32'768;
constexpr double kPrecision = 1.06;

struct Crossover {
  Choice choice;
  std::string json;

  int run();

 private:
  [[nodiscard]] bool overtakes(const std::string& partition, const std::string& scene,
                               std::size_t objects) const;
  [[nodiscard]] std::optional<std::size_t> find(const std::string& partition,
                                                const std::string& scene) const;
};

bool Crossover::overtakes(const std::string& partition, const std::string& scene,
                          std::size_t objects) const {
  MeasureOptions options;
  options.scene = scene;
  options.objects = objects;
  options.seed = choice.seed;
  options.partitions = {std::string(kBaseline), partition};
  options.threads = choice.threads;
  options.frames = objects <= 1'000 ? 501 : objects <= 4'000 ? 101 : 31;
  const Measurement measured = measure(options);
  return measured.runs[1].median_ms() < measured.runs[0].median_ms();
}

/// By bisection, on the way from "slower" to "faster"; none if it stays slower.
std::optional<std::size_t> Crossover::find(const std::string& partition,
                                           const std::string& scene) const {
  if (overtakes(partition, scene, kSmallest)) return kSmallest;
  std::size_t slower = kSmallest;
  std::size_t faster = 2 * kSmallest;
  while (!overtakes(partition, scene, faster)) {
    slower = faster;
    faster *= 2;
    if (faster > kLargest) return std::nullopt;
  }
  while (static_cast<double>(faster) > kPrecision * static_cast<double>(slower)) {
    const double middle = std::sqrt(static_cast<double>(slower) * static_cast<double>(faster));
    const auto objects = static_cast<std::size_t>(middle);
    if (objects <= slower) break;
    (overtakes(partition, scene, objects) ? faster : slower) = objects;
  }
  return faster;
}

int Crossover::run() {
  if (choice.scenes.empty()) choice.scenes = main_scenes();
  if (choice.threads.size() > 1) throw ArgumentError("--threads: one number, please");
  if (choice.threads.empty()) choice.threads = {1};
  std::vector<std::string> partitions = choice.partitions;
  if (partitions.front() == "all") {
    partitions.clear();
    for (const std::string_view name : partition_names()) {
      if (name != kBaseline && name != "NSquared") partitions.emplace_back(name);
    }
  }
  std::vector<std::string> header{"partition"};
  header.insert(header.end(), choice.scenes.begin(), choice.scenes.end());
  Table table(std::move(header));
  Json rows = Json::array();
  Progress progress(partitions.size() * choice.scenes.size());
  for (const std::string& partition : partitions) {
    std::vector<std::string> row{partition};
    for (const std::string& scene : choice.scenes) {
      progress.step(partition + ", " + scene);
      const std::optional<std::size_t> objects = find(partition, scene);
      row.push_back(!objects                ? "> " + grouped(kLargest)
                    : *objects == kSmallest ? "<= " + grouped(kSmallest)
                                            : grouped(*objects));
      rows.push_back({{"partition", partition},
                      {"scene", scene},
                      {"threads", choice.threads.front()},
                      {"objects", objects ? Json(*objects) : Json(nullptr)}});
    }
    table.add(std::move(row));
  }
  progress.clear();
  std::cout << "objects from which on a partition is faster than " << kBaseline << ", "
            << choice.threads.front() << (choice.threads.front() == 1 ? " thread, " : " threads, ")
            << isa_name() << '\n'
            << table;
  write_json(json, rows);
  return kDone;
}

}  // namespace

Command add_crossover(CLI::App& app) {
  auto crossover = std::make_shared<Crossover>();
  CLI::App* sub = app.add_subcommand(
      "crossover", "From how many objects on each partition is faster than BoundsNSquared");
  add_scenes_option(*sub, crossover->choice);
  add_threads_option(*sub, crossover->choice);
  add_partitions_option(*sub, crossover->choice);
  add_seed_option(*sub, crossover->choice);
  add_json_option(*sub, crossover->json);
  return {sub, [crossover] { return crossover->run(); }};
}

}  // namespace winnow::bench
