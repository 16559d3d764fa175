// Forwards the C++ hooks to the hooks set in C, whose argument types differ.

#include <winnow/c/hooks.h>
#include <winnow/core/hooks.h>

#include "pipeline/c/binding/structs.h"

#include <atomic>
#include <string_view>

namespace winnow::c {
namespace {

std::atomic<winnow_stage_hook> stage_hook{nullptr};
std::atomic<winnow_log_hook> log_hook{nullptr};

/// For each stage that a thread is in, the hook that was called at its begin. The same hook is
/// called at its end.
struct StagesUnderWay {
  static constexpr std::size_t kMaxStages = 32;
  winnow_stage_hook hook[kMaxStages];
  std::size_t count = 0;
};
thread_local StagesUnderWay under_way;

void pass_stage(WorkStage stage, bool begins) {
  StagesUnderWay& stages = under_way;
  if (!begins) --stages.count;
  const std::size_t depth = stages.count;
  if (begins) ++stages.count;
  if (depth >= StagesUnderWay::kMaxStages) return;
  if (begins) stages.hook[depth] = stage_hook.load(std::memory_order_acquire);
  const winnow_stage_hook hook = stages.hook[depth];
  if (hook != nullptr) hook(static_cast<winnow_work_stage>(stage), begins);
}

[[nodiscard]] winnow_text text_of(std::string_view text) noexcept {
  return {text.data(), text.size()};
}

void pass_entry(const LogEntry& entry) {
  const winnow_log_hook hook = log_hook.load(std::memory_order_acquire);
  if (hook == nullptr) return;
  const winnow_log_entry shown{static_cast<winnow_log_kind>(entry.kind),
                               text_of(entry.what),
                               text_of(entry.before),
                               text_of(entry.reason),
                               answer(entry.status),
                               entry.objects};
  hook(&shown);
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

const char* winnow_work_stage_name(winnow_work_stage stage) {
  if (stage < 0 || static_cast<std::size_t>(stage) >= winnow::kWorkStages) return "unknown";
  return winnow::to_string(static_cast<winnow::WorkStage>(stage));
}

winnow_stage_hook winnow_set_stage_hook(winnow_stage_hook hook) {
  const winnow_stage_hook before = stage_hook.exchange(hook, std::memory_order_acq_rel);
  winnow::set_stage_hook(hook == nullptr ? nullptr : &pass_stage);
  return before;
}

winnow_log_hook winnow_set_log_hook(winnow_log_hook hook) {
  const winnow_log_hook before = log_hook.exchange(hook, std::memory_order_acq_rel);
  winnow::set_log_hook(hook == nullptr ? nullptr : &pass_entry);
  return before;
}
