#include "bench/report/section.h"
#include "bench/rows/advice_rows.h"
#include "bench/rows/barrier_rows.h"
#include "bench/rows/cluster_rows.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/every_scene_rows.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/hard_case_rows.h"
#include "bench/rows/memory_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/rows/standing_rows.h"
#include "bench/trust/ledger.h"

namespace winnow::bench {
namespace {

void declare_throughput(Results& results) {
  declare_frames(results);
  declare_every_scene(results);
  declare_cold(results);
  declare_limits(results);
}

void declare_pipeline(Results& results) {
  declare_scenes(results);
  declare_flows(results);
  declare_standing(results);
}

}  // namespace

ReportSteps plan_trust(const ReportOptions& /*options*/) {
  return {{"the ledger of trust", 0.1, add_ledger}};
}

std::span<const ReportSection> report_sections() noexcept {
  static constexpr ReportSection kAll[] = {{"throughput", declare_throughput, plan_throughput},
                                           {"memory", declare_memory, plan_memory},
                                           {"stability", declare_hard_cases, plan_stability},
                                           {"motion", declare_barriers, plan_motion},
                                           {"pipeline", declare_pipeline, plan_pipeline},
                                           {"ranks", declare_cluster_runs, plan_ranks},
                                           {"advice", declare_advice, plan_advice},
                                           {"trust", declare_ledger, plan_trust}};
  return kAll;
}

}  // namespace winnow::bench
