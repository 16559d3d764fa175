#include "goals/measures.h"

#include "goals/kinds.h"
#include "tool/table.h"

#include <array>
#include <string_view>

namespace winnow::bench {
namespace {

struct Kind {
  std::string_view name;
  std::vector<Goal> (*measure)(const Ask&, const std::vector<Ask>&, Lab&);
};

constexpr std::array<Kind, 35> kKinds{{{"fastest_partition", fastest_partition},
                                       {"no_slower_than_existing", no_slower_than_existing},
                                       {"scene_ratio", scene_ratio},
                                       {"speedup", speedup},
                                       {"default_isa", default_isa},
                                       {"kernel_speedup", kernel_speedup},
                                       {"bytes_per_object", bytes_per_object},
                                       {"key_operation", key_operation},
                                       {"key_flatness", key_flatness},
                                       {"same_pairs", same_pairs},
                                       {"same_pairs_in_recordings", same_pairs_in_recordings},
                                       {"query_speed", query_speed},
                                       {"frustum_speed", frustum_speed},
                                       {"query_allocations", query_allocations},
                                       {"churn", churn},
                                       {"pair_events", pair_events},
                                       {"many_worlds", many_worlds},
                                       {"narrow_speed", narrow_speed},
                                       {"narrow_tiers", narrow_tiers},
                                       {"narrow_threads", narrow_threads},
                                       {"narrow_accuracy", narrow_accuracy},
                                       {"narrow_hard_cases", narrow_hard_cases},
                                       {"pipeline_scene", pipeline_scene},
                                       {"pipeline_tori", pipeline_tori},
                                       {"mesh_build", mesh_build},
                                       {"flow_phases", flow_phases},
                                       {"flow_soak", flow_soak},
                                       {"choice_near_best", choice_near_best},
                                       {"choice_in_recordings", choice_in_recordings},
                                       {"choice_turn", choice_turn},
                                       {"near_limit", near_limit},
                                       {"growth_exponent", growth_exponent},
                                       {"report_default", report_default},
                                       {"report_without_peers", report_without_peers},
                                       {"report_killed", report_killed}}};

}  // namespace

std::string on_size(std::size_t objects, int threads) {
  return grouped(objects) + " objects, " + std::to_string(threads) +
         (threads == 1 ? " thread" : " threads");
}

std::vector<Goal> measure_ask(const Ask& ask, const std::vector<Ask>& all, Lab& lab) {
  for (const Kind& kind : kKinds) {
    if (kind.name != ask.kind()) continue;
    std::vector<Goal> goals = kind.measure(ask, all, lab);
    for (Goal& goal : goals) goal.topic = ask.topic();
    return goals;
  }
  ask.fail("unknown kind " + ask.kind());
}

}  // namespace winnow::bench
