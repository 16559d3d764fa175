#include "bench/common/table.h"
#include "bench/report/section.h"
#include "bench/rows/memory_rows.h"

#include <algorithm>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForMemory = 150'000;
constexpr std::size_t kMostScenes = 4;

/// Memory depends little on the scene: an even one and one of many sizes, and recordings.
std::vector<NamedScene> memory_scenes(const ReportOptions& options) {
  std::vector<NamedScene> chosen;
  for (const NamedScene& scene : options.scenes) {
    if (scene.is_recording() || scene.name == "uniform" || scene.name == "mixed") {
      chosen.push_back(scene);
    }
  }
  if (chosen.empty()) chosen = options.scenes;
  if (chosen.size() > kMostScenes) chosen.resize(kMostScenes);
  return chosen;
}

std::vector<ReportStep> plan_memory(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const NamedScene& scene : memory_scenes(options)) {
    for (const std::size_t asked : options.objects) {
      const std::size_t objects = scene.objects(asked);
      if (objects > kLargestForMemory) continue;
      steps.push_back({scene.name + ", " + grouped(objects) + " objects",
                       0.1 + static_cast<double>(objects) * 1.5e-5, [=](Results& results) {
                         add_footprints_apart(results, scene, objects, options.seed,
                                              options.threads.back());
                       }});
      if (scene.is_recording()) break;
    }
  }
  return steps;
}

std::string memory_head(const Json& scene, const Json& objects) {
  return key_text(scene) + ", " + grouped(objects.get<std::size_t>()) + " objects";
}

/// By purpose at the largest size of each scene, and the sum at all sizes.
void plot_memory(const Results& results, ReportPage& page) {
  std::vector<Plot> plots;
  std::vector<std::string> purposes;
  for (const Purpose& purpose : kPurposes) purposes.emplace_back(purpose.name);
  const auto rows = results.rows("memory");
  for (const Json& scene : distinct(rows, "scene")) {
    const auto sizes = distinct(results.rows("memory", {{"scene", scene}}), "objects");
    const Json& size = *std::max_element(sizes.begin(), sizes.end());
    Plot bars{.id = "memory_" + key_text(scene),
              .title = memory_head(scene, size) + ": reserved, by purpose",
              .x = {"partition"},
              .y = {"bytes an object"}};
    add_bars(bars, results,
             {"memory", {{"scene", scene}, {"objects", size}}, "partition", purposes});
    plots.push_back(std::move(bars));
    Plot growth{.id = "memory_growth_" + key_text(scene),
                .title = key_text(scene) + ": all purposes together",
                .x = {"objects", true},
                .y = {"bytes an object"}};
    growth.series = series_of(
        results, {"memory", {{"scene", scene}}, "partition", "objects", "reserved"}, true, false);
    plots.push_back(std::move(growth));
  }
  page.add(plots);
}

/// One scene and size: what is used, reserved and resident.
PageTable memory_table(const Results& results, const Json& scene, const Json& objects) {
  PageTable table;
  table.caption = memory_head(scene, objects) + ": bytes an object";
  table.header = {"partition",         "used",        "reserved",
                  "allocated",         "resident",    "resident / reserved",
                  "peak, first frame", "peak, later", "the caller's pairs"};
  for (const Json* row : results.rows("memory", {{"scene", scene}, {"objects", objects}})) {
    Json keys;
    for (const char* key : {"scene", "objects", "partition", "threads"}) keys[key] = (*row)[key];
    const auto check = [&](const char* by) {
      Json where = keys;
      where["by"] = by;
      return cell(results, "memory_check", results.row("memory_check", where), "bytes_per_object");
    };
    table.rows.push_back(
        {text_cell(key_text(keys["partition"])), cell(results, "memory", row, "used"),
         cell(results, "memory", row, "reserved"), check(kByResource), check(kByResident),
         cell(results, "memory_ratio", results.row("memory_ratio", keys), "ratio"),
         cell(results, "memory", row, "peak_first"), cell(results, "memory", row, "peak_later"),
         cell(results, "memory", row, "pair_buffer")});
  }
  return table;
}

void show_memory(const Results& results, ReportPage& page) {
  const auto rows = results.rows("memory");
  if (rows.empty()) return;
  page.paragraph(
      "What a partition itself holds after some frames, by what it is for: the objects' boxes, "
      "keys and client data, what its structure adds, buffers that it keeps from frame to frame, "
      "and pairs on their way out. Used is what has content, reserved what it asked its memory "
      "resource for. The caller's array of pairs is not part of it.");
  plot_memory(results, page);
  page.paragraph(
      "Three witnesses: footprint() says what is reserved; the memory resource has counted what it "
      "gave; and the resident set of a process of its own shrinks by so much when the partition "
      "goes. The resident set counts whole pages that were written to: it lies below what is "
      "reserved where room is kept that no object needed yet, and above it where many small blocks "
      "round up to pages. The peaks are the most that was allocated at once, in the frame in which "
      "everything was built, and in those after it.");
  for (const Json& scene : distinct(rows, "scene")) {
    for (const Json& objects : distinct(results.rows("memory", {{"scene", scene}}), "objects")) {
      page.add(memory_table(results, scene, objects));
    }
  }
  page.command(rows.back()->value("command", ""));
  for (const char* table : {"memory", "memory_check", "memory_ratio"}) page.all_rows(table);
}

}  // namespace

const ReportSection kMemorySection{"memory", "Memory footprint", declare_memory, plan_memory,
                                   show_memory};

}  // namespace winnow::bench
