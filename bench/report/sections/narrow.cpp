#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_narrow(Results& /*results*/) {}

std::vector<ReportStep> plan_narrow(const ReportOptions& /*options*/) {
  return {};
}

void show_narrow(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kNarrowSection{"narrow", "Speed against error: narrow phase", declare_narrow,
                                   plan_narrow, show_narrow};

}  // namespace winnow::bench
