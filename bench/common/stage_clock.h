#pragma once

#include <winnow/core/hooks.h>
#include "bench/common/sample.h"

namespace winnow::bench {

/// Measures the time of one stage in calls of this thread, from its construction on. Replaces the
/// stage hook while it exists.
class StageClock {
 public:
  explicit StageClock(WorkStage stage) noexcept {
    stage_ = stage;
    ms_ = 0.0;
    before_ = set_stage_hook(note);
  }
  ~StageClock() { set_stage_hook(before_); }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

  [[nodiscard]] double ms() const noexcept { return ms_; }

 private:
  static void note(WorkStage stage, bool begins) {
    if (stage != stage_) return;
    if (begins) {
      begin_ = Stopwatch();
    } else {
      ms_ += begin_.ms();
    }
  }

  static inline thread_local WorkStage stage_{};
  static inline thread_local Stopwatch begin_;
  static inline thread_local double ms_ = 0.0;
  StageHook before_;
};

}  // namespace winnow::bench
