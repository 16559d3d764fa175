#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_volumes(Results& /*results*/) {}

std::vector<ReportStep> plan_volumes(const ReportOptions& /*options*/) {
  return {};
}

void show_volumes(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kVolumesSection{"volumes", "Speed against error: broad phase", declare_volumes,
                                    plan_volumes, show_volumes};

}  // namespace winnow::bench
