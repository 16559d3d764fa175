#include "advice/advice.h"
#include "report/scene_words.h"
#include "report/section.h"
#include "scenes/scene.h"
#include "tool/arguments.h"
#include "tool/table.h"

#include <algorithm>

namespace winnow::bench {
namespace {

constexpr std::size_t kAdvisedObjects = 10'000;
constexpr const char* kChooser = "AutoPartition";

void declare_advice(Results& results) {
  results.declare({"advice",
                   "advice",
                   "which partition to take",
                   {"scene", "objects", "threads"},
                   {{"take", "take", "", Better::neither, Format::text},
                    {"moving", "move in a frame", "", Better::neither, Format::percent},
                    {"pairs_per_object", "pairs an object", ""},
                    {"next", "next best", "", Better::neither, Format::text},
                    {"next_over_best", "next best / best", "times"},
                    {"auto_holds", "AutoPartition holds", "", Better::neither, Format::text},
                    {"auto_over_best", "AutoPartition / best", "times", Better::less},
                    {"why", "why", "", Better::neither, Format::text},
                    {"auto_why", "why AutoPartition does", "", Better::neither, Format::text},
                    {"code", "in C++", "", Better::neither, Format::text}}});
  results.declare({"advice_ranking",
                   "advice",
                   "the partitions that were to choose from",
                   {"scene", "objects", "threads", "partition"},
                   {{"frame_ms", "frame", "ms", Better::less},
                    {"first_ms", "first frame", "ms"},
                    {"bytes_per_object", "memory", "bytes/object"},
                    {"why", "why", "", Better::neither, Format::text}}});
}

/// The second that is not AutoPartition; null if there is none.
const Advised* next_best(const Advice& advice) {
  const auto at =
      std::find_if(advice.ranking.begin(), advice.ranking.end(), [&](const Advised& one) {
        return one.partition != kChooser && one.partition != advice.best().partition;
      });
  return at == advice.ranking.end() ? nullptr : &*at;
}

/// What is advised for a scene, and how it is found out again.
struct AdvicePlace {
  Json keys;
  std::string command;

  std::string add_ranked(Results& results, const Advised& one) const {
    Json row = keys;
    row["partition"] = one.partition;
    row["frame_ms"] = to_value(one.settled);
    row["first_ms"] = one.first_ms;
    row["bytes_per_object"] = static_cast<double>(one.bytes) / keys["objects"].get<double>();
    row["why"] = one.why;
    row["command"] = command;
    return results.add("advice_ranking", std::move(row));
  }
};

void add_advice(Results& results, const AdvicePlace& place, const Advice& advice) {
  const Advised* next = next_best(advice);
  Json row = place.keys;
  row["take"] = advice.best().partition;
  row["moving"] = advice.moving;
  row["pairs_per_object"] = advice.pairs / static_cast<double>(advice.objects);
  row["why"] = advice.best().why;
  row["code"] = advice.code();
  row["command"] = place.command;
  std::string best_id;
  std::string next_id;
  std::string auto_id;
  for (const Advised& one : advice.ranking) {
    const std::string id = place.add_ranked(results, one);
    if (&one == &advice.best()) best_id = id;
    if (&one == next) next_id = id;
    if (one.partition != kChooser) continue;
    auto_id = id;
    row["auto_over_best"] = one.times_best;
  }
  Json from = Json::array();
  if (next != nullptr) {
    row["next"] = next->partition;
    row["next_over_best"] = next->times_best;
    from.push_back(derived("next_over_best", "ratio", "frame_ms", {next_id, best_id}));
  }
  if (!auto_id.empty()) {
    row["auto_holds"] = advice.chosen;
    row["auto_why"] = advice.reason;
    from.push_back(derived("auto_over_best", "ratio", "frame_ms", {auto_id, best_id}));
  }
  if (!from.empty()) row["from"] = std::move(from);
  results.add("advice", std::move(row));
}

void measure_advice(Results& results, const ReportOptions& options, const ReportScene& scene,
                    std::size_t objects, int threads) {
  const auto source = scene.recording ? play(*scene.recording)
                                      : scene_or_error(scene.argument, objects, options.seed);
  const std::size_t wanted = options.quick ? 9 : 41;
  const std::size_t frames =
      scene.recording ? std::min(wanted, scene.recording->frames.size()) : wanted;
  const Advice advice = advise(*source, partitions_for({"all"}, objects).taken, frames, threads);
  std::string command = "bench/run advise " + shell_word(scene.argument);
  if (!scene.recording) {
    command += " --objects " + std::to_string(objects) + " --seed " + std::to_string(options.seed);
  }
  command += " --threads " + std::to_string(threads) + " --isa " + isa_name() + " --frames " +
             std::to_string(frames);
  add_advice(results,
             {{{"scene", scene.name}, {"objects", objects}, {"threads", threads}}, command},
             advice);
  if (!advice.same_pairs) throw std::runtime_error("not all found the same pairs");
}

std::vector<ReportStep> plan_advice(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const ReportScene& scene : options.scenes) {
    const std::size_t objects = objects_of(scene, objects_up_to(options, kAdvisedObjects));
    for (const int threads : options.threads) {
      steps.push_back(
          {scene.name + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"),
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
  table.caption = caption + ", " + key_text(threads) + (threads == 1 ? " thread" : " threads");
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
              .title = key_text(scene) + ", " + key_text(threads) +
                       (threads == 1 ? " thread" : " threads"),
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
