#include "report/sections/throughput.h"
#include "tool/table.h"

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// What the page shows of a run: its scenes, sizes, threads, and the widest instruction set.
struct ThroughputPage {
  explicit ThroughputPage(const Results& of) : results(of), isa(of.document()["machine"]["isa"]) {
    const auto rows = of.rows("throughput");
    scenes = distinct(rows, "scene");
    sizes = distinct(rows, "objects");
    threads = distinct(rows, "threads");
    std::sort(sizes.begin(), sizes.end());
    std::sort(threads.begin(), threads.end());
  }

  const Results& results;
  Json isa;
  std::vector<Json> scenes;
  std::vector<Json> sizes;
  std::vector<Json> threads;
};

std::string objects_text(const Json& objects) {
  return grouped(objects.get<std::size_t>()) + " objects";
}

std::string threads_text(const Json& threads) {
  return key_text(threads) + (threads == 1 ? " thread" : " threads");
}

bool is_quadratic(const std::string& name) {
  return name == "NSquared" || name == "BoundsNSquared";
}

void plot_growth(const ThroughputPage& of, const Json& threads, ReportPage& page) {
  std::vector<Plot> plots;
  for (const Json& scene : of.scenes) {
    Plot plot{.id = "throughput_" + key_text(scene) + "_" + key_text(threads),
              .title = key_text(scene) + ", " + threads_text(threads),
              .x = {"objects", true},
              .y = {"microseconds an object and frame", true}};
    plot.series = series_of(of.results,
                            {"throughput",
                             {{"scene", scene}, {"threads", threads}, {"isa", of.isa}},
                             "partition",
                             "objects",
                             "us_per_object"},
                            true, true);
    // Other libraries take their place where there are any.
    if (threads != of.threads.front()) {
      std::erase_if(plot.series, [](const PlotSeries& one) { return is_quadratic(one.name); });
    }
    plots.push_back(std::move(plot));
  }
  page.add(plots);
}

/// Speedups by partition, a bar for each scene, at the largest size that has any.
void plot_speedups(const ThroughputPage& of, ReportPage& page) {
  std::vector<Plot> plots;
  const Json size = of.sizes.back();
  Plot simd{.id = "throughput_simd",
            .title = key_text(of.isa) + " against the narrowest instruction set, " +
                     objects_text(size) + ", " + threads_text(of.threads.front()),
            .x = {"partition"},
            .y = {"times as fast"}};
  add_bar_groups(simd, of.results,
                 {"throughput_simd",
                  {{"objects", size}, {"threads", of.threads.front()}, {"isa", of.isa}},
                  "partition",
                  "scene",
                  "speedup"});
  plots.push_back(std::move(simd));
  Plot many{.id = "throughput_threads",
            .title = threads_text(of.threads.back()) + " against 1 thread, " + objects_text(size),
            .x = {"partition"},
            .y = {"times as fast"}};
  add_bar_groups(many, of.results,
                 {"throughput_threads",
                  {{"objects", size}, {"threads", of.threads.back()}},
                  "partition",
                  "scene",
                  "speedup"});
  plots.push_back(std::move(many));
  page.add(plots);
}

void show_size(const ThroughputPage& of, const Json& objects, ReportPage& page) {
  for (const Json& threads : of.threads) {
    const Json where{{"objects", objects}, {"threads", threads}, {"isa", of.isa}};
    page.add(pivot(of.results, {"throughput", where, "partition", "scene", "frame_ms",
                                objects_text(objects) + ", " + threads_text(threads) +
                                    ": milliseconds a frame"}));
  }
  const Json where{{"objects", objects}, {"threads", of.threads.back()}, {"isa", of.isa}};
  const std::string head = objects_text(objects) + ", " + threads_text(of.threads.back());
  page.add(pivot(of.results, {"throughput", where, "partition", "scene", "pairs_per_s",
                              head + ": million pairs a second"}));
  page.add(pivot(of.results, {"throughput", where, "partition", "scene", "update_share",
                              head + ": share of the frame that brings new boxes in"}));
}

/// Whether all found the same, scene by scene and size by size.
void show_agreement(const ThroughputPage& of, ReportPage& page) {
  PageTable table;
  table.caption = "Did all find the same pairs?";
  table.header = {"scene", "objects", "pairs a frame", "fingerprint", "found by"};
  for (const Json& scene : of.scenes) {
    for (const Json& objects : of.sizes) {
      const auto rows = of.results.rows("throughput", {{"scene", scene}, {"objects", objects}});
      if (rows.empty()) continue;
      std::string others;
      for (const Json* row : rows) {
        if ((*row)["fingerprint"] == (*rows.front())["fingerprint"]) continue;
        others += (others.empty() ? "NOT by " : ", ") + (*row)["id"].get<std::string>();
      }
      table.rows.push_back({text_cell(key_text(scene)),
                            text_cell(grouped(objects.get<std::size_t>())),
                            cell(of.results, "throughput", rows.front(), "pairs"),
                            cell(of.results, "throughput", rows.front(), "fingerprint"),
                            text_cell(others.empty() ? "all" : others)});
    }
  }
  page.add(table);
}

void show_derived(const ThroughputPage& of, ReportPage& page) {
  for (const Json& threads : of.threads) {
    page.add(pivot(of.results, {"throughput_growth",
                                {{"threads", threads}},
                                "partition",
                                "scene",
                                "exponent",
                                "Exponent of growth, " + threads_text(threads),
                                false}));
  }
  const Json& size = of.sizes.back();
  for (const Json& isa : distinct(of.results.rows("throughput_simd"), "isa")) {
    page.add(pivot(of.results, {"throughput_simd",
                                {{"objects", size}, {"threads", of.threads.front()}, {"isa", isa}},
                                "partition",
                                "scene",
                                "speedup",
                                key_text(isa) + " against the narrowest instruction set, times, " +
                                    objects_text(size) + ", " + threads_text(of.threads.front()),
                                false}));
  }
  page.add(pivot(of.results, {"throughput_threads",
                              {{"objects", size}, {"threads", of.threads.back()}},
                              "partition",
                              "scene",
                              "speedup",
                              threads_text(of.threads.back()) + " against 1 thread, times, " +
                                  objects_text(size),
                              false}));
}

void show_skipped(const Results& results, ReportPage& page) {
  std::string text;
  for (const Json* row : results.rows("throughput_skipped")) {
    text += (text.empty() ? "" : "; ") + objects_text((*row)["objects"]) + ": " +
            (*row)["skipped"].get<std::string>();
  }
  if (!text.empty()) page.paragraph("Not run, because they would take too long: " + text + ".");
}

}  // namespace

void show_throughput(const Results& results, ReportPage& page) {
  const ThroughputPage of(results);
  if (of.scenes.empty()) return;
  page.paragraph(
      "A frame is what a simulation pays each step: the boxes that moved are brought in, whatever "
      "the structure needs is rebuilt, and every pair of overlapping boxes is written to an array. "
      "Partitions take turns, some frames each, so that they meet the same disturbances. Those "
      "that test every box against every other, and other libraries, take long: they have races of "
      "their own, on the first of the same frames (all rows tell how many frames they had). Lower "
      "is better; a line that stays level costs the same for each object however many there are.");
  plot_growth(of, of.threads.front(), page);
  if (of.threads.size() > 1) {
    page.paragraph(
        "With all threads, and beside other libraries (dashed). Of these Embree uses the "
        "threads there are, CGAL does where that is faster for it, and Bullet, FCL and ODE find "
        "pairs on one thread, whatever the heading says.");
    plot_growth(of, of.threads.back(), page);
  }
  for (const Json& objects : of.sizes) {
    page.heading(objects_text(objects));
    show_size(of, objects, page);
  }
  show_skipped(results, page);
  page.heading("Growth, instruction sets, threads");
  page.paragraph(
      "An exponent of 1 means that twice the objects take twice the time; 2 means four times. It "
      "is fitted to the sizes that the engine was run at, and tells of growth alone: one that is "
      "slow at every size may have a small one. The speedups compare medians of the same race.");
  plot_speedups(of, page);
  show_derived(of, page);
  page.heading("The same pairs");
  show_agreement(of, page);
  const auto rows = results.rows("throughput", {{"isa", of.isa}});
  if (!rows.empty()) page.command(rows.front()->value("command", ""));
  for (const char* table : {"throughput", "throughput_growth", "throughput_simd",
                            "throughput_threads", "throughput_skipped"}) {
    page.all_rows(table);
  }
}

}  // namespace winnow::bench
