#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_memory(Results& /*results*/) {}

std::vector<ReportStep> plan_memory(const ReportOptions& /*options*/) {
  return {};
}

void show_memory(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kMemorySection{"memory", "Memory footprint", declare_memory, plan_memory,
                                   show_memory};

}  // namespace winnow::bench
