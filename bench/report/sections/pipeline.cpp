#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_pipeline(Results& /*results*/) {}

std::vector<ReportStep> plan_pipeline(const ReportOptions& /*options*/) {
  return {};
}

void show_pipeline(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kPipelineSection{"pipeline", "Pipeline", declare_pipeline, plan_pipeline,
                                     show_pipeline};

}  // namespace winnow::bench
