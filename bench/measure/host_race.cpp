#include "bench/measure/host_race.h"

#include "bench/common/thread_pool.h"
#include "bench/contenders/partition_engine.h"
#include "bench/measure/race.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {

HostRace race_hosts(FrameSource& source, std::string_view partition, int threads,
                    std::size_t frames) {
  constexpr std::size_t kWarmingFrames = 5;
  ThreadPool pool(static_cast<std::size_t>(threads));
  std::vector<Contender> contenders;
  contenders.push_back({std::make_unique<PartitionEngine>(partition, threads), threads});
  contenders.push_back(
      {std::make_unique<PartitionEngine>(partition, Execution::on(pool.jobs())), 1});
  std::vector<Run> runs = race(source, contenders, {.frames = kWarmingFrames + frames, .block = 1});
  if (!all_agree(runs)) throw std::runtime_error("the threads of a pool find other pairs");
  for (Run& run : runs) {
    const auto warming = std::min(kWarmingFrames, run.frame_ms.size());
    run.frame_ms.erase(run.frame_ms.begin(),
                       run.frame_ms.begin() + static_cast<std::ptrdiff_t>(warming));
  }
  return {std::move(runs[0].frame_ms), std::move(runs[1].frame_ms)};
}

}  // namespace winnow::bench
