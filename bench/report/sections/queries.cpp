#include "report/section.h"

namespace winnow::bench {
namespace {

void declare_queries(Results& /*results*/) {}

std::vector<ReportStep> plan_queries(const ReportOptions& /*options*/) {
  return {};
}

void show_queries(const Results& /*results*/, ReportPage& /*page*/) {}

}  // namespace

const ReportSection kQueriesSection{"queries", "Queries", declare_queries, plan_queries,
                                    show_queries};

}  // namespace winnow::bench
