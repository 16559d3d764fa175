#include "bench/rows/rows.h"

#include <winnow/pipeline/cluster_transport.h>
#include "bench/measure/cluster_run.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

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

/// Returns the number of ghosts for each body that a rank owns, if `ranks` ranks share a cube with
/// evenly spread boxes. The centres of the ghosts are in the rank's cube grown by half an edge on
/// all sides, minus the cube itself.
double ghosts_by_formula(double objects, double ranks, const BoxSpread& spread) {
  const double side = std::cbrt(objects / ranks / spread.density);
  return std::pow(1.0 + spread.edge / side, 3.0) - 1.0;
}

std::string cluster_command(const ClusterRowOptions& options, std::uint32_t ranks) {
  const std::string size = " --objects " + std::to_string(options.objects);
  const std::string seed = " --seed " + std::to_string(options.seed);
  return command_text("cluster ", shell_word(options.scene.argument),
                      options.scene.is_recording() ? "" : size, options.seed == 1 ? "" : seed,
                      " --frames ", options.frames, " --virtual-ranks ", ranks);
}

/// Adds the ghosts that the formula predicts for numbers of objects that exceed the memory of a
/// machine.
void add_model(Results& results, const ClusterRowOptions& options, const BoxSpread& spread) {
  constexpr std::pair<double, double> kSizes[] = {{1e6, 64}, {1e6, 4096}, {1e8, 1024}, {1e9, 1e4}};
  for (const auto& [objects, ranks] : kSizes) {
    const double ghosts = ghosts_by_formula(objects, ranks, spread);
    // Bytes to send for a ghost that moved: its name, its box and its owner.
    constexpr double kGhostBytes = sizeof(BodyName) + sizeof(Aabb) + sizeof(std::uint8_t);
    results.add("cluster_model", {{"scene", options.scene.name},
                                  {"objects", static_cast<std::uint64_t>(objects)},
                                  {"ranks", static_cast<std::uint64_t>(ranks)},
                                  {"ghosts", ghosts},
                                  {"rank_bytes", kGhostBytes * ghosts * (objects / ranks)},
                                  {"command", cluster_command(options, 1)}});
  }
}

bool are_same(const ClusterRun& a, const ClusterRun& b) {
  return std::ranges::equal(a.frames, b.frames, [](const ClusterFrame& x, const ClusterFrame& y) {
    return x.pairs.fingerprint == y.pairs.fingerprint && x.digest == y.digest;
  });
}

Json row_of(const ClusterRowOptions& options, std::uint32_t ranks, const ClusterRun& run,
            bool same) {
  const ClusterFrame& last = run.frames.back();
  const std::size_t count = options.scene.objects(options.objects);
  const auto objects = static_cast<double>(count);
  return {{"scene", options.scene.name},
          {"objects", count},
          {"ranks", ranks},
          {"same", same ? "yes" : "NO"},
          {"pairs", last.pairs.pairs},
          {"ghosts", static_cast<double>(last.statistics.ghosts) / objects},
          {"sent_bytes", last.statistics.bytes},
          {"messages", last.statistics.messages},
          {"imbalance", last.statistics.imbalance},
          {"bytes_per_object", static_cast<double>(run.bytes) / objects},
          {"fingerprint", to_hex(last.pairs.fingerprint)},
          {"command", cluster_command(options, ranks)}};
}

}  // namespace

void add_cluster_runs(Results& results, const ClusterRowOptions& options) {
  const bool is_uniform = options.scene.name == "uniform" && !options.scene.is_recording();
  BoxSpread spread{};
  ClusterRun one;
  bool all_same = true;
  for (const std::uint32_t ranks : options.ranks) {
    const auto source = options.scene.source(options.objects, options.seed);
    spread = spread_of_boxes(*source);
    LoopbackTransport transport(ranks);
    const ClusterRun run =
        run_cluster(*source, transport, {options.frames, std::nullopt}, Execution::serial());
    if (one.frames.empty()) one = run;
    const bool same = are_same(one, run);
    all_same = all_same && same;
    Json row = row_of(options, ranks, run, same);
    if (is_uniform && ranks > 1) {
      row["formula"] = ghosts_by_formula(value_of(row, "objects"), ranks, spread);
    }
    results.add("cluster_runs", std::move(row));
  }
  if (is_uniform) add_model(results, options, spread);
  if (!all_same) throw std::runtime_error(options.scene.name + ": ranks find other pairs than one");
}

}  // namespace winnow::bench
