#include "report/scene_words.h"
#include "report/section.h"
#include "tool/measure_footprint.h"
#include "tool/own_process.h"
#include "tool/table.h"

#include <algorithm>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForMemory = 150'000;
constexpr std::size_t kMostScenes = 4;
constexpr const char* kByFootprint = "footprint()";
constexpr const char* kByResource = "memory resource";
constexpr const char* kByResident = "resident set";

void declare_memory(Results& results) {
  std::vector<ValueColumn> values;
  for (const Purpose& purpose : kPurposes) {
    values.push_back({purpose.name, purpose.label, "bytes/object"});
  }
  values.push_back({"reserved", "reserved", "bytes/object", Better::less});
  values.push_back({"peak_first", "peak of the first frame", "bytes/object", Better::less});
  values.push_back({"peak_later", "peak of a later frame", "bytes/object", Better::less});
  for (const Purpose& purpose : kPurposes) {
    const std::string name = purpose.name;
    values.push_back({name + "_used", std::string(purpose.label) + ", used", "bytes/object"});
  }
  values.push_back({"used", "used", "bytes/object"});
  values.push_back({"pair_buffer", "the caller's pairs", "bytes/object"});
  values.push_back({"exact", "equals what was allocated", "", Better::neither, Format::text});
  results.declare({"memory",
                   "memory",
                   "bytes an object by purpose",
                   {"scene", "objects", "partition", "threads"},
                   std::move(values)});
  results.declare({"memory_check",
                   "memory",
                   "the whole partition, told in three ways",
                   {"scene", "objects", "partition", "threads", "by"},
                   {{"bytes_per_object", "memory", "bytes/object"}}});
  results.declare({"memory_ratio",
                   "memory",
                   "what the system holds over what footprint() says is reserved",
                   {"scene", "objects", "partition", "threads"},
                   {{"ratio", "resident / reserved", "times"}}});
}

/// The rows of one partition, as `winnow footprint` wrote it.
void add_held(Results& results, const std::string& scene, const Json& held,
              const std::string& command) {
  const double n = held["objects"].get<double>();
  const auto each = [n](const Json& bytes) { return bytes.get<double>() / n; };
  const Json keys{{"scene", scene},
                  {"objects", held["objects"]},
                  {"partition", held["partition"]},
                  {"threads", held["threads"]}};
  Json row = keys;
  for (const Purpose& purpose : kPurposes) {
    row[purpose.name] = each(held[purpose.name]["reserved"]);
    row[std::string(purpose.name) + "_used"] = each(held[purpose.name]["used"]);
  }
  row["reserved"] = each(held["total"]["reserved"]);
  row["used"] = each(held["total"]["used"]);
  for (const char* name : {"peak_first", "peak_later", "pair_buffer"}) row[name] = each(held[name]);
  row["exact"] = held["exact"].get<bool>() ? "yes" : "NO";
  row["command"] = command;
  results.add("memory", std::move(row));

  const auto add_check = [&](const char* by, const Json& bytes) {
    Json check = keys;
    check["by"] = by;
    check["bytes_per_object"] = each(bytes);
    check["command"] = command;
    return results.add("memory_check", std::move(check));
  };
  const std::string told = add_check(kByFootprint, held["total"]["reserved"]);
  add_check(kByResource, held["allocated"]);
  if (held["resident"] == 0) return;  // the system does not tell
  const std::string resident = add_check(kByResident, held["resident"]);
  Json ratio = keys;
  ratio["ratio"] = held["resident"].get<double>() / held["total"]["reserved"].get<double>();
  ratio["from"] = derived("ratio", "ratio", "bytes_per_object", {resident, told});
  ratio["command"] = command;
  results.add("memory_ratio", std::move(ratio));
}

/// In a process of its own, whose memory nothing else disturbs.
void measure_memory(Results& results, const ReportOptions& options, const ReportScene& scene,
                    std::size_t objects) {
  const std::string threads = std::to_string(options.threads.back());
  std::vector<std::string> arguments{"footprint", "--scene", scene.argument, "--threads",
                                     threads,     "--isa",   isa_name()};
  if (!scene.recording) {
    arguments.insert(arguments.end(), {"--objects", std::to_string(objects), "--seed",
                                       std::to_string(options.seed)});
  }
  bool exact = true;
  for (const Json& held : run_own(arguments)) {
    add_held(results, scene.name, held,
             "bench/run footprint" + scene_words(options, scene, objects) + " --threads " +
                 threads + " --isa " + isa_name() + " --partition " +
                 held["partition"].get<std::string>());
    exact = exact && held["exact"].get<bool>();
  }
  if (!exact) throw std::runtime_error("a footprint does not equal what was allocated");
}

/// Memory depends little on the scene: an even one and one of many sizes, and recordings.
std::vector<ReportScene> memory_scenes(const ReportOptions& options) {
  std::vector<ReportScene> chosen;
  for (const ReportScene& scene : options.scenes) {
    if (scene.recording || scene.name == "uniform" || scene.name == "mixed") {
      chosen.push_back(scene);
    }
  }
  if (chosen.empty()) chosen = options.scenes;
  if (chosen.size() > kMostScenes) chosen.resize(kMostScenes);
  return chosen;
}

std::vector<ReportStep> plan_memory(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const ReportScene& scene : memory_scenes(options)) {
    for (const std::size_t asked : options.objects) {
      const std::size_t objects = objects_of(scene, asked);
      if (objects > kLargestForMemory) continue;
      steps.push_back({scene.name + ", " + grouped(objects) + " objects",
                       0.1 + static_cast<double>(objects) * 1.5e-5, [=](Results& results) {
                         measure_memory(results, options, scene, objects);
                       }});
      if (scene.recording) break;
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
