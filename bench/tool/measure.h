#pragma once

#include "engine/race.h"
#include "recordings/recording.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// One race on one scene: every partition at every thread count on every instruction set.
struct MeasureOptions {
  std::string scene;
  const Recording* recording = nullptr;  ///< instead of the scene
  std::size_t objects = 10'000;
  std::uint64_t seed = 1;
  std::vector<std::string> partitions{"all"};
  std::vector<int> threads{1};
  std::vector<Isa> isas;   ///< empty: the active one
  bool peers = false;      ///< other libraries too, where the tool was built with them
  bool reference = false;  ///< the reference sweep too, as the judge of what overlaps
  bool machine_clock = false;
  std::size_t frames = 0;  ///< the first one included; 0: what suits the size
};

struct Measurement {
  std::string scene;
  std::size_t objects = 0;
  std::vector<Run> runs;             ///< partitions, then peers, then the reference
  std::size_t partition_runs = 0;    ///< how many of them, from the front, are partitions
  std::size_t peer_runs = 0;         ///< how many after these are other libraries
  std::vector<std::string> skipped;  ///< too slow for the size
  double machine_ms = 0.0;           ///< of the MachineClock, interleaved with the race

  [[nodiscard]] std::span<const Run> partitions() const {
    return std::span(runs).first(partition_runs);
  }
  [[nodiscard]] std::span<const Run> peers() const {
    return std::span(runs).subspan(partition_runs, peer_runs);
  }
  /// Null if it did not run.
  [[nodiscard]] const Run* find(const std::string& engine, int threads) const;
  /// The fastest partition at this thread count; null if none ran.
  [[nodiscard]] const Run* fastest(int threads) const;
  /// The fastest other library at this thread count; null if none ran.
  [[nodiscard]] const Run* fastest_peer(int threads) const;
  [[nodiscard]] double bytes_per_object(const Run& run) const {
    return static_cast<double>(run.bytes) / static_cast<double>(objects);
  }
};

[[nodiscard]] Measurement measure(const MeasureOptions& options);

/// Frames that give a steady median in a second or so.
[[nodiscard]] std::size_t frames_for(std::size_t objects);

/// False if this tool was built without other libraries.
[[nodiscard]] bool has_peers();

}  // namespace winnow::bench
