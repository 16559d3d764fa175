#include "report/sections/volumes.h"

namespace winnow::bench {
namespace {

/// What a volume gives away beside what it costs, and where the time goes.
void add_volumes_setting(const Results& results, const Json& what, const std::string& id,
                         std::vector<Plot>& plots) {
  const Json where{{"objects_are", what}, {"partition", kVolumesPartition}};
  const Json* first = results.row("volumes", where);
  const std::string title =
      key_text(what) + ", " + shown((*first)["objects"].get<double>(), "count") + " objects";
  Plot front{.id = id + "_front",
             .title = title,
             .x = {"making and broad phase, ms a frame", true},
             .y = {"false positives, share of reported pairs", false}};
  front.series = series_of(
      results, {"volumes", where, "volume", "found_ms", "false_positives", false}, true, false);
  front.series.push_back(pareto_front(front.series));
  plots.push_back(std::move(front));
  Plot bars{.id = id + "_end_to_end",
            .title = title + ", end to end",
            .x = {"volume", false},
            .y = {"ms a frame", false}};
  add_bars(bars, results, {"volumes", where, "volume", {"make_ms", "broad_ms", "narrow_ms"}});
  plots.push_back(std::move(bars));
}

void show_volume_kinds(const Results& results, ReportPage& page) {
  const Json where{{"partition", kVolumesPartition}};
  const auto rows = results.rows("volumes", where);
  if (rows.empty()) return;
  page.heading("Volumes and margins");
  page.paragraph(
      "A broad phase compares simple volumes instead of shapes, and reports pairs that do not "
      "touch: false positives, each of which costs an exact test. Left: the lower, the fewer of "
      "them; the further left, the cheaper; only what lies on the dotted line is worth its price. "
      "Right: the same with the exact test of overlap of every reported pair (boxes, tier robust); "
      "dearer tests move the balance to tighter volumes. Objects of built-in scenes and recordings "
      "are upright boxes: there an AABB is the object itself and reports nothing in vain, but for "
      "rounding. All in " +
      std::string(kVolumesPartition) + ", one thread.");
  std::vector<Plot> plots;
  for (const Json& what : distinct(rows, "objects_are")) {
    add_volumes_setting(results, what, "volumes_" + std::to_string(plots.size() / 2), plots);
  }
  page.add(plots);
  page.command((*rows.front())["command"]);
  for (const char* value : {"false_positives", "found_ms", "sum_ms", "pays_from_ns"}) {
    page.add(pivot(results, {"volumes", where, "volume", "objects_are", value}));
  }
  page.paragraph(
      "The last table: how many nanoseconds the exact test of a pair must cost before the volume "
      "pays off against plain boxes; without a figure, it spares no pair.");
  page.add(pivot(results, {"volumes", where, "volume", "objects_are", "bytes_per_object"}));
}

void show_volume_partitions(const Results& results, ReportPage& page) {
  std::vector<Plot> plots;
  std::vector<PageTable> tables;
  const auto rows = results.rows("volumes");
  for (const Json& what : distinct(rows, "objects_are")) {
    const Json where{{"objects_are", what}};
    if (distinct(results.rows("volumes", where), "partition").size() < 2) continue;
    Plot plot{.id = "volumes_partitions_" + std::to_string(plots.size()),
              .title = key_text(what) + ", every partition",
              .x = {"broad phase, ms a frame", true},
              .y = {"false positives, share of reported pairs", false}};
    plot.series =
        series_of(results, {"volumes", where, "partition", "broad_ms", "false_positives", false},
                  true, false);
    plot.series.push_back(pareto_front(plot.series));
    plots.push_back(std::move(plot));
    const std::string name = key_text(what);
    tables.push_back(pivot(results, {"volumes", where, "partition", "volume", "false_positives",
                                     "false positives, " + name, false}));
    tables.push_back(pivot(results, {"volumes", where, "partition", "volume", "broad_ms",
                                     "broad phase, ms, " + name}));
  }
  if (plots.empty()) return;
  page.heading("The same volumes in other partitions");
  page.paragraph(
      "Every partition hands on exactly the pairs whose volumes overlap, so that it decides the "
      "time and the volume decides the false positives: rows of dots at one height are one volume "
      "in several partitions.");
  page.add(plots);
  for (const PageTable& table : tables) page.add(table);
}

void show_margins(const Results& results, ReportPage& page) {
  if (results.rows("margins").empty()) return;
  page.heading("Margins by speed");
  page.paragraph(
      "A margin lets an object move a little before the partition must be told; the wider, the "
      "more pairs are reported in vain. What it is worth depends on how far objects go in a "
      "frame.");
  std::vector<Plot> plots;
  for (const auto& [value, label] :
       {std::pair{"broad_ms", "broad phase, ms a frame"},
        std::pair{"sum_ms", "volumes, broad phase and exact test, ms a frame"}}) {
    Plot plot{.id = std::string("margins_") + value,
              .title = "rotated cubes",
              .x = {"way in a frame, edges", true},
              .y = {label, true}};
    plot.series =
        series_of(results, {"margins", Json::object(), "volume", "step", value}, true, true);
    plots.push_back(std::move(plot));
  }
  page.add(plots);
  const auto rows = results.rows("margins");
  page.command((*rows.back())["command"]);
  for (const char* value : {"broad_ms", "sum_ms"}) {
    const std::string what = value == std::string("broad_ms") ? "broad phase" : "all three";
    page.add(pivot(results, {"margins", Json::object(), "volume", "step", value,
                             what + ", ms, by edges that objects go in a frame"}));
  }
}

void show_box_widths(const Results& results, ReportPage& page) {
  if (results.rows("box_widths").empty()) return;
  page.heading("Bounds of 16 bits");
  page.paragraph(
      "Boxes rounded to 16 bits within the box of their group take half the memory, and more of "
      "them are tested at once; but they let some pairs pass in vain, and must be made anew in "
      "each frame. One mark for each kind of objects.");
  Plot plot{.id = "volumes_widths",
            .title = "float against 16 bits",
            .x = {"test of all boxes, ms", true},
            .y = {"false positives, share of hits", false}};
  plot.series = series_of(
      results, {"box_widths", Json::object(), "boxes", "test_ms", "false_positives", false}, true,
      false);
  page.add({plot});
  for (const char* value : {"false_positives", "test_ms", "make_ms"}) {
    page.add(pivot(results, {"box_widths", Json::object(), "boxes", "objects_are", value}));
  }
}

}  // namespace

void show_volumes(const Results& results, ReportPage& page) {
  show_volume_kinds(results, page);
  show_volume_partitions(results, page);
  show_margins(results, page);
  show_box_widths(results, page);
  for (const char* table : {"volumes", "margins", "box_widths"}) page.all_rows(table);
}

}  // namespace winnow::bench
