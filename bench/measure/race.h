#pragma once

#include <winnow/simd/isa.h>
#include "bench/common/sample.h"
#include "bench/contenders/engine.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/fingerprint.h"
#include "bench/recordings/recording.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// Who takes part in a race, and how.
struct Contender {
  std::unique_ptr<Engine> engine;
  int threads = 1;
  Isa isa = active_isa();
};

/// Frames until which a contender has settled.
inline constexpr std::size_t kSettlingFrames = 6;

/// What one contender did, one entry per frame; entry 0 is the first frame, in which it was built.
struct Run {
  std::string engine;
  int threads = 1;
  Isa isa{};
  std::vector<double> frame_ms;
  std::vector<double> update_ms;
  std::vector<PairSummary> pairs;
  std::vector<std::size_t> changed;  ///< boxes; of the first frame none
  /// When it gave up the frame after these; 0: it gave up none.
  double gave_up_ms = 0.0;
  std::size_t bytes = 0;

  /// The frames after which it had settled; none if there were fewer.
  [[nodiscard]] std::span<const double> settled_ms() const noexcept;
  /// Of the frames after the first; of the first if there is no other.
  [[nodiscard]] Spread frame_spread() const;
  [[nodiscard]] double median_update_ms() const;
  [[nodiscard]] double pairs_a_frame() const;
  [[nodiscard]] double reported_a_frame() const;
  /// In the frames that both have finished.
  [[nodiscard]] bool same_pairs(const Run& other) const noexcept;
};

/// How long a contender may take, in seconds; 0: as long as it takes.
struct TimeBounds {
  /// Once its frames after the first have taken so long it begins no more; but it has three, so
  /// that one that was disturbed is not the median.
  double run = 0.0;
  double frame = 0.0;  ///< a frame that takes longer is given up by engines that can

  [[nodiscard]] bool any() const noexcept { return run > 0.0 || frame > 0.0; }
};

struct RaceOptions {
  std::size_t frames = 30;  ///< the first one included; fewer if the source ends
  /// Frames that a contender runs in a row before the next one runs the same: long enough for its
  /// data to be warm, short enough for all to meet the same disturbances.
  std::size_t block = 5;
  MachineClock* clock = nullptr;  ///< ticks before each block
  TimeBounds bounds{};
};

/// Runs all contenders over the same frames, interleaved. What changed between frames is found
/// outside the timers, because a simulation knows what it moved; and so are the fingerprints. The
/// instruction set is what it was when this returns.
[[nodiscard]] std::vector<Run> race(FrameSource& source, std::vector<Contender>& contenders,
                                    const RaceOptions& options);

/// One contender for each partition.
[[nodiscard]] std::vector<Contender> make_contenders(const std::vector<std::string>& partitions,
                                                     int threads);

/// True if all runs found the same pairs in every frame that they have finished.
[[nodiscard]] bool all_agree(const std::vector<Run>& runs) noexcept;

/// One race on one scene: every partition at every thread count on every instruction set.
struct MeasureOptions {
  std::string scene{};
  const Recording* recording = nullptr;  ///< instead of the scene
  std::size_t objects = 10'000;
  std::uint64_t seed = 1;
  std::vector<std::string> partitions{"all"};
  std::vector<int> threads{1};
  std::vector<Isa> isas{};  ///< empty: the active one
  bool peers = false;       ///< other libraries too, where the tool was built with them
  bool yardstick = false;   ///< the yardstick too, where the tool was built with it
  bool reference = false;   ///< the reference sweep too, as the judge of what overlaps
  bool machine_clock = false;
  std::size_t frames = 0;  ///< the first one included; 0: what suits the size
  TimeBounds bounds{};     ///< with any, libraries take part that would be too slow for the size
};

struct Measurement {
  std::string scene{};
  std::size_t objects = 0;
  bool grows = false;              ///< from frame to frame there may be more of them
  std::vector<Run> runs;           ///< partitions, then peers, then the reference
  std::size_t partition_runs = 0;  ///< how many of them, from the front, are partitions
  std::size_t peer_runs = 0;       ///< how many after these are other libraries, the yardstick last
  std::vector<std::string> skipped;  ///< too slow for the size
  double machine_ms = 0.0;           ///< of the MachineClock, interleaved with the race

  [[nodiscard]] std::span<const Run> partitions() const {
    return std::span(runs).first(partition_runs);
  }
  [[nodiscard]] std::span<const Run> peers() const {
    return std::span(runs).subspan(partition_runs, peer_runs);
  }
};

[[nodiscard]] Measurement measure(const MeasureOptions& options);

/// Frames that give a steady median in a second or so.
[[nodiscard]] std::size_t frames_for(std::size_t objects);

}  // namespace winnow::bench
