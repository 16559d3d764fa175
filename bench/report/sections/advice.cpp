#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_advice(Results& /*results*/) {}

std::vector<ReportStep> plan_advice(const ReportOptions& /*options*/) {
  return {};
}

void show_advice(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kAdviceSection{"advice", "Which one should I use", declare_advice, plan_advice,
                                   show_advice};

}  // namespace winnow::bench
