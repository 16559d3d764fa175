#include "bench/rows/every_scene_rows.h"

#include "bench/contenders/partitions.h"
#include "bench/peers/yardstick.h"
#include "bench/rows/frame_rows.h"

#include <span>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Returns the spread of the frames after a partition has settled; if there are none, of the frames
/// after the first.
Spread settled_spread(const Run& run) {
  const auto settled = run.settled_ms();
  return settled.empty() ? run.frame_spread() : spread_of(settled);
}

}  // namespace

void add_every_scene(Results& results, const EverySceneOptions& options) {
  const Measurement raced = measure({.scene = options.scene.argument,
                                     .recording = options.scene.recording.get(),
                                     .objects = options.objects,
                                     .seed = options.seed,
                                     .partitions = unlimited_partitions(),
                                     .threads = {options.threads},
                                     .yardstick = options.yardstick,
                                     .frames = options.frames});
  const Run& last = raced.runs.back();
  const double yardstick_ms = last.engine == kYardstickName ? settled_spread(last).median : 0.0;
  for (const Run& run : raced.runs) {
    const Spread settled = settled_spread(run);
    Json row{
        {"scene", options.scene.name},
        {"objects", raced.objects},
        {"partition", run.engine},
        {"threads", run.threads},
        {"median_ms", settled.median},
        {"worst_ms", settled.max},
        {"first_ms", run.frame_ms.front()},
        {"worst_ratio", settled.max / settled.median},
        {"pairs", run.pairs_a_frame()},
        {"command", "bench/run dev throughput" + options.scene.words(raced.objects, options.seed) +
                        " --threads " + std::to_string(run.threads) + " --isa " +
                        to_string(run.isa) + " --frames " + std::to_string(run.frame_ms.size()) +
                        (run.engine == kYardstickName ? " --partition LinearBvh --yardstick"
                                                      : " --partition " + run.engine)}};
    if (yardstick_ms > 0.0) row["over_yardstick"] = settled.median / yardstick_ms;
    results.add("every_scene", std::move(row));
  }
  if (!all_agree(raced.runs)) throw std::runtime_error("not all found the same pairs");
}

}  // namespace winnow::bench
