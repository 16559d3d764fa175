#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_stability(Results& /*results*/) {}

std::vector<ReportStep> plan_stability(const ReportOptions& /*options*/) {
  return {};
}

void show_stability(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kStabilitySection{"stability", "Numerical stability", declare_stability,
                                      plan_stability, show_stability};

}  // namespace winnow::bench
