#include "bench/rows/rows.h"

#include <winnow/pipeline/cluster_transport.h>
#include "bench/measure/cluster_run.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace winnow::bench {
namespace {

std::string cluster_command(const ClusterRowOptions& options, std::uint32_t ranks) {
  const std::string size = " --objects " + std::to_string(options.objects);
  const std::string seed = " --seed " + std::to_string(options.seed);
  return command_text("cluster ", shell_word(options.scene.argument),
                      options.scene.is_recording() ? "" : size, options.seed == 1 ? "" : seed,
                      " --frames ", options.frames, " --virtual-ranks ", ranks);
}

Json row_of(const ClusterRowOptions& options, std::uint32_t ranks, const ClusterRun& run,
            bool same) {
  const ClusterStatistics& last = run.statistics.back();
  const std::size_t count = options.scene.objects(options.objects);
  const auto objects = static_cast<double>(count);
  return {{"scene", options.scene.name},
          {"objects", count},
          {"ranks", ranks},
          {"same", same ? "yes" : "NO"},
          {"pairs", last.pairs},
          {"ghosts", static_cast<double>(last.ghosts) / objects},
          {"sent_bytes", last.bytes},
          {"messages", last.messages},
          {"imbalance", last.imbalance},
          {"bytes_per_object", static_cast<double>(run.bytes) / objects},
          {"fingerprint", to_hex(run.pairs.back().fingerprint)},
          {"command", cluster_command(options, ranks)}};
}

}  // namespace

void add_cluster_runs(Results& results, const ClusterRowOptions& options) {
  ClusterRun one;
  bool all_same = true;
  for (const std::uint32_t ranks : options.ranks) {
    const auto source = options.scene.source(options.objects, options.seed);
    LoopbackTransport transport(ranks);
    const ClusterRun run =
        run_cluster(*source, transport, {options.frames, std::nullopt}, Execution::serial());
    if (one.frame_ms.empty()) one = run;
    const bool same = run.same_pairs(one) && run.digests == one.digests;
    all_same = all_same && same;
    results.add("cluster_runs", row_of(options, ranks, run, same));
  }
  if (!all_same) throw std::runtime_error(options.scene.name + ": ranks find other pairs than one");
}

}  // namespace winnow::bench
