#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/report/section.h"
#include "bench/rows/frame_rows.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForPeers = 150'000;
/// Above it the structures of all instruction sets would fill the memory if they raced at once.
constexpr std::size_t kLargestForOneRace = 300'000;
/// At what sizes keys and limits are measured.
constexpr std::size_t kKeyedObjects = 10'000;
constexpr std::size_t kLimitedObjects = 100'000;
constexpr const char* kLimitValues[] = {"bandwidth_ms", "sort_ms",   "permute_ms", "emission_ms",
                                        "limit_ms",     "partition", "frame_ms",   "ratio"};

void declare_throughput(Results& results) {
  declare_frames(results);
  declare_keys(results);
  declare_limits(results);
}

/// Frames that give a steady median in little time.
std::size_t throughput_frames(const ReportOptions& options, std::size_t objects) {
  if (options.quick) return 4;
  if (objects <= 2'000) return 31;
  if (objects <= 20'000) return 21;
  return objects <= kLargestForOneRace ? 11 : 6;
}

std::size_t frames_of_slow(const ReportOptions& options, std::size_t objects) {
  if (options.quick) return kFingerprintFrames;
  return objects <= 20'000 ? 6 : kFingerprintFrames;
}

/// One race, or one for each instruction set where all would be too much.
void race_partitions(Results& results, const ReportOptions& options, const NamedScene& scene,
                     std::size_t objects, const std::vector<std::string>& partitions,
                     std::size_t frames) {
  if (partitions.empty()) return;
  MeasureOptions race{.objects = objects,
                      .seed = options.seed,
                      .partitions = partitions,
                      .threads = options.threads,
                      .isas = options.isas,
                      .frames = frames};
  if (objects <= kLargestForOneRace) {
    add_frame_race(results, scene, race);
    return;
  }
  for (const Isa isa : options.isas) {
    race.isas = {isa};
    add_frame_race(results, scene, race);
  }
}

/// Partitions that suit any size first, then those that take longer.
void measure_throughput(Results& results, const ReportOptions& options, const NamedScene& scene,
                        std::size_t objects) {
  const Partitions partitions = partitions_for({"all"}, objects);
  note_skipped(results, objects, partitions.skipped, false);
  std::vector<std::string> fast;
  std::vector<std::string> slow;
  for (const std::string& name : partitions.taken) {
    const bool limited = largest_for(name) != std::numeric_limits<std::size_t>::max();
    (limited ? slow : fast).push_back(name);
  }
  race_partitions(results, options, scene, objects, fast, throughput_frames(options, objects));
  race_partitions(results, options, scene, objects, slow, frames_of_slow(options, objects));
  derive_frames(results, scene.name, objects);
  const Json where{{"scene", scene.name}, {"objects", objects}};
  if (distinct(results.rows("throughput", where), "fingerprint").size() > 1) {
    throw std::runtime_error("not all found the same pairs");
  }
}

/// With as many threads as may be, beside a partition whose pairs theirs must equal.
void measure_peers(Results& results, const ReportOptions& options, const NamedScene& scene,
                   std::size_t objects) {
  add_frame_race(results, scene,
                 {.objects = objects,
                  .seed = options.seed,
                  .partitions = {"LinearBvh"},
                  .threads = {options.threads.back()},
                  .isas = {options.isas.back()},
                  .peers = true,
                  .frames = frames_of_slow(options, objects)},
                 true);
  derive_frames(results, scene.name, objects);
}

void measure_keys(Results& results, std::size_t objects, bool quick) {
  for (const std::string& partition : testing_partitions()) {
    if (quick && partition != "LinearBvh") continue;
    for (const bool random_order : {false, true}) {
      add_key_costs(results, partition, objects, random_order);
    }
  }
}

std::vector<ReportStep> plan_throughput(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const NamedScene& scene : options.scenes) {
    for (const std::size_t asked : options.objects) {
      const std::size_t objects = scene.objects(asked);
      const auto n = static_cast<double>(objects);
      const std::string what = scene.name + ", " + grouped(objects) + " objects";
      steps.push_back({what, options.quick ? 0.1 : 0.4 + n * 5.5e-5, [=](Results& results) {
                         measure_throughput(results, options, scene, objects);
                       }});
      if (options.peers && objects <= kLargestForPeers) {
        steps.push_back({what + ", other libraries", n * 6e-5, [=](Results& results) {
                           measure_peers(results, options, scene, objects);
                         }});
      }
      if (scene.is_recording()) break;
    }
  }
  const std::size_t keyed = objects_up_to(options, kKeyedObjects);
  steps.push_back({"keys", options.quick ? 0.1 : 1.5, [=, quick = options.quick](Results& results) {
                     measure_keys(results, keyed, quick);
                   }});
  const std::size_t limited = objects_up_to(options, kLimitedObjects);
  steps.push_back({"limits", options.quick ? 0.1 : 1.0, [=](Results& results) {
                     for (const NamedScene& scene : options.scenes) {
                       add_limit(results, scene.name, scene.objects(limited));
                     }
                   }});
  return steps;
}

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

bool is_quadratic(const std::string& name) {
  return name == "NSquared" || name == "BoundsNSquared";
}

void plot_growth(const ThroughputPage& of, const Json& threads, ReportPage& page) {
  std::vector<Plot> plots;
  for (const Json& scene : of.scenes) {
    Plot plot{.id = "throughput_" + key_text(scene) + "_" + key_text(threads),
              .title = key_text(scene) + ", " + threads_text(threads.get<int>()),
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
                     objects_text(size) + ", " + threads_text(of.threads.front().get<int>()),
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
            .title = threads_text(of.threads.back().get<int>()) + " against 1 thread, " +
                     objects_text(size),
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
                                objects_text(objects) + ", " + threads_text(threads.get<int>()) +
                                    ": milliseconds a frame"}));
  }
  const Json where{{"objects", objects}, {"threads", of.threads.back()}, {"isa", of.isa}};
  const std::string head =
      objects_text(objects) + ", " + threads_text(of.threads.back().get<int>());
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
                                "Exponent of growth, " + threads_text(threads.get<int>()),
                                false}));
  }
  const Json& size = of.sizes.back();
  for (const Json& isa : distinct(of.results.rows("throughput_simd"), "isa")) {
    page.add(pivot(of.results,
                   {"throughput_simd",
                    {{"objects", size}, {"threads", of.threads.front()}, {"isa", isa}},
                    "partition",
                    "scene",
                    "speedup",
                    key_text(isa) + " against the narrowest instruction set, times, " +
                        objects_text(size) + ", " + threads_text(of.threads.front().get<int>()),
                    false}));
  }
  page.add(pivot(of.results, {"throughput_threads",
                              {{"objects", size}, {"threads", of.threads.back()}},
                              "partition",
                              "scene",
                              "speedup",
                              threads_text(of.threads.back().get<int>()) +
                                  " against 1 thread, times, " + objects_text(size),
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

/// What operations on keys cost, and what memory alone asks of a frame.
void show_costs(const Results& results, ReportPage& page) {
  if (!results.rows("keys").empty()) {
    page.heading("Keys");
    page.paragraph(
        "Nanoseconds of inserting, updating and removing an object, a tenth of the objects at a "
        "time, "
        "in one call or one by one, keys in the order in which they were handed out.");
    for (const char* mode : {"bulk", "single"}) {
      page.add(pivot(results, {"keys",
                               {{"order", "insertion"}, {"mode", mode}},
                               "partition",
                               "operation",
                               "ns",
                               std::string(mode) + ", ns an object"}));
    }
  }
  if (results.rows("limits").empty()) return;
  page.heading("How far from the limit");
  page.paragraph(
      "What a frame must do if everything moves and nothing is kept from the frame before, each as "
      "a "
      "plain loop on data of the same size, beside the best partition on one thread. Rows that "
      "stay "
      "in the order of the last build spare the sort and most of the fetching: a coherent scene "
      "may "
      "lie below the sum.");
  PageTable table{"ms, 1 thread", {"scene"}, {}};
  for (const char* value : kLimitValues)
    table.header.push_back(heading_of(*results.column("limits", value)));
  for (const Json* row : results.rows("limits")) {
    table.rows.push_back({text_cell(key_text((*row)["scene"]))});
    for (const char* value : kLimitValues)
      table.rows.back().push_back(cell(results, "limits", row, value));
  }
  page.add(table);
}

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
  show_costs(results, page);
  page.heading("The same pairs");
  show_agreement(of, page);
  const auto rows = results.rows("throughput", {{"isa", of.isa}});
  if (!rows.empty()) page.command(rows.front()->value("command", ""));
  for (const char* table : {"throughput", "throughput_growth", "throughput_simd",
                            "throughput_threads", "throughput_skipped", "keys", "limits"}) {
    page.all_rows(table);
  }
}

}  // namespace

const ReportSection kThroughputSection{"throughput", "Throughput", declare_throughput,
                                       plan_throughput, show_throughput};

}  // namespace winnow::bench
