#pragma once

#include "engine/fingerprint.h"
#include "engine/sample.h"
#include "peers/engine.h"
#include "scenes/frame_source.h"

#include <winnow/simd/isa.h>

#include <functional>
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

/// What one contender did, one entry a frame; entry 0 is the first frame, in which it was built.
struct Run {
  std::string engine;
  int threads = 1;
  Isa isa{};
  std::vector<double> frame_ms;
  std::vector<double> update_ms;
  std::vector<PairSummary> pairs;
  std::size_t bytes = 0;

  /// Of the frames after the first; of the first if there is no other.
  [[nodiscard]] Spread frame_spread() const;
  [[nodiscard]] double median_ms() const { return frame_spread().median; }
  [[nodiscard]] double median_update_ms() const;
  [[nodiscard]] double pairs_a_frame() const;
  [[nodiscard]] double reported_a_frame() const;
  [[nodiscard]] bool same_pairs(const Run& other) const noexcept;
};

struct RaceOptions {
  std::size_t frames = 30;  ///< the first one included; fewer if the source ends
  /// Frames that a contender runs in a row before the next one runs the same: long enough for its
  /// data to be warm, short enough for all to meet the same disturbances.
  std::size_t block = 5;
  /// Called before each block with the number of frames done, outside all timers.
  std::function<void(std::size_t frames_done)> before_block;
};

/// Runs all contenders over the same frames, interleaved. What changed between frames is found
/// outside the timers, because a simulation knows what it moved; and so are the fingerprints. The
/// instruction set is what it was when this returns.
[[nodiscard]] std::vector<Run> race(FrameSource& source, std::vector<Contender>& contenders,
                                    const RaceOptions& options);

/// True if all runs found the same pairs in every frame.
[[nodiscard]] bool all_agree(const std::vector<Run>& runs) noexcept;

}  // namespace winnow::bench
