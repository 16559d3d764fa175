#include "report/sections/pipeline.h"

#include <iterator>

namespace winnow::bench {
namespace {

void declare_pipeline(Results& results) {
  declare_whole_scenes(results);
  declare_flows(results);
}

std::vector<ReportStep> plan_pipeline(const ReportOptions& options) {
  std::vector<ReportStep> steps = plan_whole_scenes(options);
  std::vector<ReportStep> flows = plan_flows(options);
  steps.insert(steps.end(), std::make_move_iterator(flows.begin()),
               std::make_move_iterator(flows.end()));
  return steps;
}

void show_pipeline(const Results& results, ReportPage& page) {
  show_whole_scenes(results, page);
  show_flows(results, page);
  for (const char* table : {"whole_scenes", "scene_ratios", "scene_levels", "tori", "mesh_builds",
                            "phases", "flows", "flow"}) {
    page.all_rows(table);
  }
}

}  // namespace

const ReportSection kPipelineSection{"pipeline", "Pipeline", declare_pipeline, plan_pipeline,
                                     show_pipeline};

}  // namespace winnow::bench
