#include "report/section.h"
#include "tool/measure.h"
#include "tool/table.h"

namespace winnow::bench {
namespace {

void declare_throughput(Results& results) {
  results.declare({"throughput",
                   "throughput",
                   "a frame of every partition",
                   {"scene", "objects", "partition", "threads", "isa"},
                   {{"frame_ms", "frame", "ms", Better::less},
                    {"us_per_object", "frame", "us/object", Better::less},
                    {"update_ms", "of it update", "ms", Better::less},
                    {"pairs", "pairs", "", Better::neither, Format::count},
                    {"pairs_per_s", "pairs", "1/s", Better::more, Format::count},
                    {"frames", "frames", "", Better::neither, Format::count},
                    {"fingerprint", "pairs of all frames", "", Better::neither, Format::text}}});
}

std::string command_of(const ReportScene& scene, std::size_t objects, const Run& run) {
  std::string text = "bench/run ";
  text += scene.recording
              ? "replay " + scene.argument
              : "throughput --scene " + scene.argument + " --objects " + std::to_string(objects);
  return text + " --threads " + std::to_string(run.threads) + " --isa " + to_string(run.isa) +
         " --partition " + run.engine + " --frames " + std::to_string(run.frame_ms.size());
}

/// Of the pairs of all frames.
std::string fingerprint_of(const Run& run) {
  std::uint64_t sum = 0;
  for (const PairSummary& frame : run.pairs) sum += frame.fingerprint;
  return to_hex(sum);
}

void add_run(Results& results, const ReportScene& scene, std::size_t objects, const Run& run) {
  std::vector<double> ms = run.frame_ms;
  if (ms.size() > 1) ms.erase(ms.begin());
  const double median = median_of(ms);
  results.add("throughput", {{"scene", scene.name},
                             {"objects", objects},
                             {"partition", run.engine},
                             {"threads", run.threads},
                             {"isa", to_string(run.isa)},
                             {"frame_ms", to_value(ms)},
                             {"us_per_object", 1e3 * median / static_cast<double>(objects)},
                             {"update_ms", run.median_update_ms()},
                             {"pairs", run.pairs_a_frame()},
                             {"pairs_per_s", 1e3 * run.pairs_a_frame() / median},
                             {"frames", run.frame_ms.size()},
                             {"fingerprint", fingerprint_of(run)},
                             {"command", command_of(scene, objects, run)}});
}

void measure_cell(Results& results, const ReportOptions& options, const ReportScene& scene,
                  std::size_t objects) {
  MeasureOptions cell;
  cell.scene = scene.argument;
  cell.recording = scene.recording.get();
  cell.objects = objects;
  cell.seed = options.seed;
  cell.threads = options.threads;
  cell.isas = options.isas;
  cell.frames = options.quick ? 4 : 11;
  const Measurement measured = measure(cell);
  for (const Run& run : measured.runs) add_run(results, scene, measured.objects, run);
  if (!all_agree(measured.runs)) throw std::runtime_error("not all found the same pairs");
}

std::vector<ReportStep> plan_throughput(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const ReportScene& scene : options.scenes) {
    for (const std::size_t objects : options.objects) {
      steps.push_back({scene.name + ", " + grouped(objects) + " objects",
                       static_cast<double>(objects) * 5e-5,
                       [=](Results& results) { measure_cell(results, options, scene, objects); }});
      if (scene.recording) break;
    }
  }
  return steps;
}

void show_throughput(const Results& results, ReportPage& page) {
  const auto rows = results.rows("throughput");
  if (rows.empty()) return;
  const Json isa = results.document()["machine"]["isa"];
  std::vector<Plot> plots;
  for (const Json& scene : distinct(rows, "scene")) {
    Plot plot{.id = "throughput_" + key_text(scene),
              .title = key_text(scene) + ", 1 thread",
              .x = {"objects", true},
              .y = {"microseconds an object and frame", true}};
    plot.series = series_of(results,
                            {"throughput",
                             {{"scene", scene}, {"threads", 1}, {"isa", isa}},
                             "partition",
                             "objects",
                             "us_per_object"},
                            true, true);
    plots.push_back(std::move(plot));
  }
  page.add(plots);
  page.all_rows("throughput");
}

}  // namespace

const ReportSection kThroughputSection{"throughput", "Throughput", declare_throughput,
                                       plan_throughput, show_throughput};

}  // namespace winnow::bench
