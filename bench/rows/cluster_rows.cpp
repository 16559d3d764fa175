#include "bench/rows/cluster_rows.h"

#include <winnow/core/execution.h>
#include <winnow/pipeline/cluster_transport.h>
#include "bench/common/sample.h"
#include "bench/measure/cluster_run.h"
#include "bench/measure/fingerprint.h"

#include <cmath>
#include <optional>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Number of boxes in a unit of volume, and their mean edge length.
struct BoxSpread {
  double density;
  double edge;
};

BoxSpread spread_of_boxes(const FrameSource& source) {
  double volume = 1.0;
  const Aabb world = source.world();
  for (int axis = 0; axis < 3; ++axis) {
    volume *= static_cast<double>(world.max[axis]) - static_cast<double>(world.min[axis]);
  }
  double edges = 0.0;
  for (const Aabb& box : source.boxes()) {
    for (int axis = 0; axis < 3; ++axis) {
      edges += static_cast<double>(box.max[axis]) - static_cast<double>(box.min[axis]);
    }
  }
  const auto count = static_cast<double>(source.boxes().size());
  return {count / volume, edges / (3.0 * count)};
}

std::string cluster_command(const ClusterRowOptions& options, std::uint32_t ranks) {
  std::string words = "bench/run cluster " + shell_word(options.scene.argument);
  if (!options.scene.is_recording()) words += " --objects " + std::to_string(options.objects);
  if (options.seed != 1) words += " --seed " + std::to_string(options.seed);
  return words + " --frames " + std::to_string(options.frames) + " --virtual-ranks " +
         std::to_string(ranks);
}

/// Adds the ghosts that the formula predicts for numbers of objects that exceed the memory of a
/// machine.
void add_model(Results& results, const ClusterRowOptions& options, const BoxSpread& spread) {
  struct Size {
    std::uint64_t objects;
    std::uint64_t ranks;
  };
  for (const Size& size : {Size{1'000'000, 64}, Size{1'000'000, 4096}, Size{100'000'000, 1024},
                           Size{1'000'000'000, 10'000}}) {
    const auto objects = static_cast<double>(size.objects);
    const auto ranks = static_cast<double>(size.ranks);
    const double ghosts = ghosts_by_formula(objects, ranks, spread.density, spread.edge);
    // Bytes to send for a ghost that moved: its name, its box and its owner.
    constexpr double kGhostBytes = sizeof(BodyName) + sizeof(Aabb) + sizeof(std::uint8_t);
    const double own = objects / ranks;
    results.add("cluster_model", {{"scene", options.scene.name},
                                  {"objects", size.objects},
                                  {"ranks", size.ranks},
                                  {"ghosts", ghosts},
                                  {"rank_bytes", kGhostBytes * ghosts * own},
                                  {"command", cluster_command(options, 1)}});
  }
}

bool are_same(const ClusterRun& a, const ClusterRun& b) {
  bool same = a.frames.size() == b.frames.size();
  for (std::size_t i = 0; same && i < a.frames.size(); ++i) {
    same = a.frames[i].pairs.fingerprint == b.frames[i].pairs.fingerprint &&
           a.frames[i].digest == b.frames[i].digest;
  }
  return same;
}

void add_run(Results& results, const ClusterRowOptions& options, std::uint32_t ranks,
             const ClusterRun& run, bool same, const BoxSpread& spread) {
  const ClusterStatistics& last = run.frames.back().statistics;
  const std::size_t count = options.scene.objects(options.objects);
  const auto objects = static_cast<double>(count);
  Json row{{"scene", options.scene.name},
           {"objects", count},
           {"ranks", ranks},
           {"same", same ? "yes" : "NO"},
           {"pairs", run.frames.back().pairs.pairs},
           {"ghosts", static_cast<double>(last.ghosts) / objects},
           {"sent_bytes", last.bytes},
           {"messages", last.messages},
           {"imbalance", last.imbalance},
           {"bytes_per_object", static_cast<double>(run.bytes) / objects},
           {"fingerprint", to_hex(run.frames.back().pairs.fingerprint)},
           {"command", cluster_command(options, ranks)}};
  if (options.is_uniform && ranks > 1) {
    row["formula"] = ghosts_by_formula(objects, ranks, spread.density, spread.edge);
  }
  results.add("cluster_runs", std::move(row));
}

}  // namespace

double ghosts_by_formula(double objects, double ranks, double density, double edge) {
  const double side = std::cbrt(objects / ranks / density);
  return std::pow(1.0 + edge / side, 3.0) - 1.0;
}

void add_cluster_runs(Results& results, const ClusterRowOptions& options) {
  ClusterRun one;
  bool all_same = true;
  for (const std::uint32_t ranks : options.ranks) {
    const auto source = options.scene.source(options.objects, options.seed);
    const BoxSpread spread = spread_of_boxes(*source);
    LoopbackTransport transport(ranks);
    const ClusterRun run =
        run_cluster(*source, transport, {options.frames, std::nullopt}, Execution::serial());
    if (one.frames.empty()) one = run;
    const bool same = are_same(one, run);
    all_same = all_same && same;
    add_run(results, options, ranks, run, same, spread);
    if (options.is_uniform && ranks == options.ranks.front()) add_model(results, options, spread);
  }
  if (!all_same) throw std::runtime_error(options.scene.name + ": ranks find other pairs than one");
}

}  // namespace winnow::bench
