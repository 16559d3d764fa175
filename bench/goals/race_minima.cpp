#include "bench/goals/race_minima.h"

#include "bench/contenders/partitions.h"

#include <algorithm>

namespace winnow::bench {

std::vector<Run> race_minima(const std::function<std::unique_ptr<FrameSource>()>& make_source,
                             const std::vector<std::string>& partitions, std::size_t frames,
                             int threads) {
  constexpr int kRounds = 3;
  std::vector<Run> runs;
  for (int round = 0; round < kRounds; ++round) {
    const std::unique_ptr<FrameSource> source = make_source();
    std::vector<Contender> contenders =
        make_contenders(partitions_for(partitions, source->objects()).taken, threads);
    RaceOptions options;
    options.frames = frames;
    options.block = 1;
    std::vector<Run> again = race(*source, contenders, options);
    if (runs.empty()) runs = again;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      for (std::size_t f = 0; f < runs[i].frame_ms.size(); ++f) {
        runs[i].frame_ms[f] = std::min(runs[i].frame_ms[f], again[i].frame_ms[f]);
      }
    }
  }
  return runs;
}

}  // namespace winnow::bench
