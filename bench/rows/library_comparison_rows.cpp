#include "bench/rows/library_comparison_rows.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>

namespace winnow::bench {
namespace {

/// The frames of a race by which a library is compared.
struct JudgedFrames {
  std::size_t first = 1;
  std::size_t count = 0;
  bool mean = false;
  std::string name;

  JudgedFrames(const Run& peer, bool grows) : mean(grows) {
    const std::size_t finished = peer.frame_ms.size();
    if (finished > 1) {
      count = finished - 1;
      name = grows ? "mean frame" : "median frame";
      if (peer.gave_up_ms > 0.0) name += " until it gave up";
    } else if (peer.gave_up_ms > 0.0) {
      first = finished;
      count = 1;
      name = first == 0 ? "first frame, given up" : "second frame, given up";
    }
  }

  [[nodiscard]] double of(const Run& run) const {
    const auto ms = std::span(run.frame_ms).subspan(first, count);
    if (!mean) return median_of(ms);
    return std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(count);
  }
  [[nodiscard]] double of_peer(const Run& peer) const {
    return first < peer.frame_ms.size() ? of(peer) : peer.gave_up_ms;
  }
  [[nodiscard]] bool are_in(const Run& run) const noexcept {
    return first + count <= run.frame_ms.size();
  }
};

/// Returns the fastest partition with this many threads; null if none ran all of these frames.
const Run* best_of(const Measurement& raced, int threads, const JudgedFrames& frames) {
  const Run* best = nullptr;
  for (const Run& run : raced.partitions()) {
    if (run.threads != threads || !frames.are_in(run)) continue;
    if (best == nullptr || frames.of(run) < frames.of(*best)) best = &run;
  }
  return best;
}

}  // namespace

Measurement add_beside_peers(Results& results, const NamedScene& scene, MeasureOptions options) {
  options.scene = scene.argument;
  options.recording = scene.recording.get();
  options.peers = true;
  Measurement raced = measure(options);
  for (const Run& peer : raced.peers()) {
    const JudgedFrames frames(peer, raced.grows);
    const Run* best = frames.count > 0 ? best_of(raced, peer.threads, frames) : nullptr;
    if (best == nullptr) continue;
    results.add("beside_peers",
                {{"scene", scene.name},
                 {"objects", raced.objects},
                 {"partition", peer.engine},
                 {"threads", peer.threads},
                 {"of", frames.name},
                 {"times", frames.of_peer(peer) / frames.of(*best)},
                 {"ms", frames.of_peer(peer)},
                 {"best_ms", frames.of(*best)},
                 {"best", best->engine},
                 {"frames", frames.count},
                 {"command", "bench/run --with-peers dev throughput --peers" +
                                 scene.words(raced.objects, options.seed) + " --threads " +
                                 std::to_string(peer.threads) + " --partition " + best->engine +
                                 " --frames " + std::to_string(frames.first + frames.count)}});
  }
  if (!all_agree(raced.runs)) throw std::runtime_error("not all found the same pairs");
  return raced;
}

}  // namespace winnow::bench
