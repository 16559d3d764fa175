#pragma once

#include <winnow/core/hooks.h>

#include <atomic>

namespace winnow {

extern std::atomic<StageHook> stage_hook;

/// Reports a stage to the stage hook: it begins with the constructor and ends with the destructor.
class StageScope {
 public:
  explicit StageScope(WorkStage stage) noexcept
      : hook_(stage_hook.load(std::memory_order_acquire)), stage_(stage) {
    if (hook_ != nullptr) hook_(stage_, true);
  }
  ~StageScope() {
    if (hook_ != nullptr) hook_(stage_, false);
  }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageHook hook_;
  WorkStage stage_;
};

}  // namespace winnow
