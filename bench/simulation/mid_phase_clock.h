#pragma once

#include <winnow/core/hooks.h>
#include "bench/common/sample.h"

namespace winnow::bench {

/// Measures the time of the stage WorkStage::mid_phase of calls of this thread, from its
/// construction on. Replaces the stage hook while it exists.
class MidPhaseClock {
 public:
  MidPhaseClock() noexcept {
    ms_ = 0.0;
    before_ = set_stage_hook(note);
  }
  ~MidPhaseClock() { set_stage_hook(before_); }
  MidPhaseClock(const MidPhaseClock&) = delete;
  MidPhaseClock& operator=(const MidPhaseClock&) = delete;

  [[nodiscard]] double ms() const noexcept { return ms_; }

 private:
  static void note(WorkStage stage, bool begins) {
    if (stage != WorkStage::mid_phase) return;
    if (begins) {
      stage_ = Stopwatch();
    } else {
      ms_ += stage_.ms();
    }
  }

  static inline thread_local Stopwatch stage_;
  static inline thread_local double ms_ = 0.0;
  StageHook before_;
};

}  // namespace winnow::bench
