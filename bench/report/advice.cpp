#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/report/section.h"
#include "bench/rows/advice_rows.h"

#include <algorithm>

namespace winnow::bench {
namespace {

constexpr std::size_t kAdvisedObjects = 10'000;

void measure_advice(Results& results, const ReportOptions& options, const NamedScene& scene,
                    std::size_t objects, int threads) {
  const std::size_t wanted = options.quick ? 9 : 41;
  const std::size_t frames =
      scene.is_recording() ? std::min(wanted, scene.recording->frames.size()) : wanted;
  add_advice(results, scene, objects, options.seed, partitions_for({"all"}, objects).taken, frames,
             threads);
}

std::vector<ReportStep> plan_advice(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const NamedScene& scene : options.scenes) {
    const std::size_t objects = scene.objects(objects_up_to(options, kAdvisedObjects));
    for (const int threads : options.threads) {
      steps.push_back(
          {scene.name + ", " + threads_text(threads),
           options.quick ? 0.1 : 0.1 + static_cast<double>(objects) * 1.1e-4,
           [=](Results& results) { measure_advice(results, options, scene, objects, threads); }});
    }
  }
  return steps;
}

/// Stands in the ranking, not with the advice.
constexpr const char* kFrameOfBest = "frame_ms";

PageCell frame_of_best(const Results& results, const Json& advised) {
  Json where;
  for (const char* key : {"scene", "objects", "threads"}) where[key] = advised[key];
  where["partition"] = advised["take"];
  return cell(results, "advice_ranking", results.row("advice_ranking", where), kFrameOfBest);
}

PageTable advice_table(const Results& results, const Json& threads,
                       const std::vector<std::string>& values, const std::string& caption) {
  PageTable table;
  table.caption = caption + ", " + threads_text(threads.get<int>());
  table.header = {"scene", "objects"};
  for (const std::string& value : values) {
    const Json* column = results.column(value == kFrameOfBest ? "advice_ranking" : "advice", value);
    if (column != nullptr) table.header.push_back(heading_of(*column));
  }
  for (const Json* row : results.rows("advice", {{"threads", threads}})) {
    std::vector<PageCell> cells{text_cell(key_text((*row)["scene"])),
                                text_cell(grouped((*row)["objects"].get<std::size_t>()))};
    for (const std::string& value : values) {
      cells.push_back(value == kFrameOfBest ? frame_of_best(results, *row)
                                            : cell(results, "advice", row, value));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// What building costs against what a frame costs, for one number of threads.
void plot_advice(const Results& results, const Json& threads, ReportPage& page) {
  std::vector<Plot> plots;
  for (const Json* row : results.rows("advice", {{"threads", threads}})) {
    const Json& scene = (*row)["scene"];
    Plot plot{.id = "advice_" + key_text(scene) + "_" + key_text((*row)["objects"]),
              .title = key_text(scene) + ", " + threads_text(threads.get<int>()),
              .x = {"first frame, which builds: ms", true},
              .y = {"later frames: ms", true}};
    const Json where{{"scene", scene}, {"objects", (*row)["objects"]}, {"threads", threads}};
    plot.series = series_of(
        results, {"advice_ranking", where, "partition", "first_ms", "frame_ms", false}, true, true);
    plot.series.push_back(pareto_front(plot.series));
    plots.push_back(std::move(plot));
  }
  page.add(plots);
}

void show_advice(const Results& results, ReportPage& page) {
  const auto rows = results.rows("advice");
  if (rows.empty()) return;
  page.paragraph(
      "For each scene, the partition that took the least time for a frame once it had settled, "
      "of those that do not choose by themselves; what made it so, and the line that makes it. How "
      "far the next best lies behind says how much the choice matters. AutoPartition chooses by "
      "itself, from counts and a sample and never from time; take it where a scene changes its "
      "nature, or where only your users know it.");
  const auto all_threads = distinct(rows, "threads");
  for (const Json& threads : all_threads) {
    page.add(advice_table(results, threads,
                          {"take", kFrameOfBest, "moving", "pairs_per_object", "next",
                           "next_over_best", "auto_holds", "auto_over_best"},
                          "Which partition"));
  }
  for (const Json& threads : all_threads) {
    page.add(advice_table(results, threads, {"why", "code"}, "Why, and how"));
  }
  page.add(advice_table(results, all_threads.front(), {"auto_holds", "auto_why"},
                        "What AutoPartition said"));
  page.command(rows.front()->value("command", ""));
  page.paragraph(
      "A scene that is built anew often, or lives for few frames, pays for building too. Lower and "
      "further left is better; nothing beats what lies on the dotted line in both.");
  plot_advice(results, all_threads.front(), page);
  for (const char* table : {"advice", "advice_ranking"}) page.all_rows(table);
}

}  // namespace

const ReportSection kAdviceSection{"advice", "Which one should I use", declare_advice, plan_advice,
                                   show_advice};

}  // namespace winnow::bench
