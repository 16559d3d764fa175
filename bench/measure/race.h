#pragma once

#include <winnow/simd/isa.h>
#include "bench/common/sample.h"
#include "bench/contenders/engines.h"
#include "bench/measure/fingerprint.h"
#include "bench/recordings/recording.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// An engine in the race, and its settings.
struct Contender {
  std::unique_ptr<Engine> engine;
  int threads = 1;
  Isa isa = active_isa();
};

/// Number of frames until a contender has settled.
inline constexpr std::size_t kSettlingFrames = 6;

/// Results of one contender, one entry per frame; entry 0 is the first frame, in which it was
/// built.
struct Run {
  std::string engine;
  int threads = 1;
  Isa isa{};
  std::vector<double> frame_ms;
  std::vector<double> update_ms;
  std::vector<PairSummary> pairs;
  std::vector<std::size_t> changed;  ///< number of changed boxes; 0 for the first frame
  std::size_t bytes = 0;

  /// Returns the times of the frames after settling; empty if there are none.
  [[nodiscard]] std::span<const double> settled_ms() const noexcept;
  /// Returns the times of the frames after the first, or of the first if it is the only one.
  [[nodiscard]] std::span<const double> later_ms() const noexcept;
  [[nodiscard]] Spread frame_spread() const { return spread_of(later_ms()); }
  [[nodiscard]] std::span<const double> later_update_ms() const noexcept;
  [[nodiscard]] double median_update_ms() const { return median_of(later_update_ms()); }
  [[nodiscard]] double pairs_a_frame() const;
  [[nodiscard]] double reported_a_frame() const;
  /// Compares the frames that both runs have.
  [[nodiscard]] bool same_pairs(const Run& other) const noexcept;
};

struct RaceOptions {
  std::size_t frames = 30;  ///< including the first; fewer if the source ends
  /// Frames that a contender runs in sequence before the next one runs the same: long enough to
  /// keep its data in the caches, short enough that disturbances affect all contenders alike.
  std::size_t block = 5;
};

/// Runs all contenders over the same frames, interleaved. Changed boxes are determined outside the
/// timers, because a simulation has that list already; fingerprints are not timed either. Restores
/// the active instruction set.
[[nodiscard]] std::vector<Run> race(FrameSource& source, std::vector<Contender>& contenders,
                                    const RaceOptions& options);

/// Makes one contender for each partition.
[[nodiscard]] std::vector<Contender> make_contenders(const std::vector<std::string>& partitions,
                                                     int threads);

/// Returns true if all runs found the same pairs in every frame.
[[nodiscard]] bool all_agree(const std::vector<Run>& runs) noexcept;

/// Options of a race on one scene: every partition at every thread count on every instruction set.
struct MeasureOptions {
  std::string scene{};
  const Recording* recording = nullptr;  ///< replaces the scene
  std::size_t objects = 10'000;
  std::uint64_t seed = 1;
  std::vector<std::string> partitions{"all"};
  std::vector<int> threads{1};
  std::vector<Isa> isas{};  ///< empty: the active one
  bool peers = false;       ///< also other libraries, if the tool was built with them
  bool yardstick = false;   ///< also the yardstick, if the tool was built with it
  std::size_t frames = 0;   ///< including the first; 0: chosen by the number of objects
};

struct Measurement {
  std::string scene{};
  std::size_t objects = 0;
  bool grows = false;                ///< objects may be added from frame to frame
  std::vector<Run> runs;             ///< partitions, then peers
  std::size_t partition_runs = 0;    ///< number of partitions, at the front of `runs`
  std::size_t peer_runs = 0;         ///< other libraries, behind the partitions; the yardstick last
  std::vector<std::string> skipped;  ///< libraries too slow for the size

  [[nodiscard]] std::span<const Run> partitions() const {
    return std::span(runs).first(partition_runs);
  }
  [[nodiscard]] std::span<const Run> peers() const {
    return std::span(runs).subspan(partition_runs, peer_runs);
  }
};

[[nodiscard]] Measurement measure(const MeasureOptions& options);

/// Returns a number of frames that gives a stable median in about a second.
[[nodiscard]] std::size_t frames_for(std::size_t objects);

}  // namespace winnow::bench
