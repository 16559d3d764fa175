#include <winnow/core/hooks.h>

#include "core/hooks/log.h"
#include "core/hooks/stage_scope.h"

namespace winnow {

std::atomic<StageHook> stage_hook{nullptr};
std::atomic<LogHook> log_hook{nullptr};

const char* to_string(WorkStage stage) noexcept {
  switch (stage) {
    case WorkStage::refresh:
      return "refresh";
    case WorkStage::build:
      return "build";
    case WorkStage::pairs:
      return "pairs";
    case WorkStage::mid_phase:
      return "mid_phase";
    case WorkStage::narrow_phase:
      return "narrow_phase";
    case WorkStage::contacts:
      return "contacts";
  }
  return "unknown";
}

StageHook set_stage_hook(StageHook hook) noexcept {
  return stage_hook.exchange(hook);
}

LogHook set_log_hook(LogHook hook) noexcept {
  return log_hook.exchange(hook);
}

void log_refusal(Status status, const char* call) noexcept {
  const LogHook hook = log_hook.load(std::memory_order_acquire);
  if (hook == nullptr) return;
  hook({.kind = LogEntry::Kind::refusal,
        .what = call,
        .reason = to_string(status),
        .status = status});
}

void log_choice(std::string_view before, std::string_view now, std::string_view reason,
                std::size_t objects) noexcept {
  const LogHook hook = log_hook.load(std::memory_order_acquire);
  if (hook == nullptr) return;
  hook({.kind = LogEntry::Kind::choice,
        .what = now,
        .before = before,
        .reason = reason,
        .objects = objects});
}

}  // namespace winnow
