#include "engine/sample.h"
#include "plots/plot_page.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <iostream>
#include <utility>

namespace winnow::bench {
namespace {

struct Size {
  std::size_t objects = 0;
  double ms = 0.0;
  double bytes_per_object = 0.0;
};

/// What each partition did at every size, in the order of the sizes; partitions in the order of
/// reports.
using Growths = std::vector<std::pair<std::string, std::vector<Size>>>;

std::vector<Size>& sizes_of(Growths& growths, const std::string& partition) {
  for (auto& [name, sizes] : growths) {
    if (name == partition) return sizes;
  }
  return growths.emplace_back(partition, std::vector<Size>()).second;
}

double exponent_of(const std::vector<Size>& sizes) {
  std::vector<GrowthPoint> points;
  for (const Size& size : sizes) points.push_back({static_cast<double>(size.objects), size.ms});
  return fitted_exponent(points);
}

struct Growth {
  Choice choice;
  std::size_t frames = 0;
  std::string json;
  std::string out;

  int run();

 private:
  Growths measure_scene(const std::string& scene, Progress& progress) const;
  void print(const std::string& scene, const Growths& growths) const;
};

Growths Growth::measure_scene(const std::string& scene, Progress& progress) const {
  Growths growths;
  for (const std::size_t objects : choice.objects) {
    progress.step(scene + ", " + grouped(objects) + " objects");
    MeasureOptions options;
    options.scene = scene;
    options.objects = objects;
    options.seed = choice.seed;
    options.partitions = choice.partitions;
    options.threads = choice.threads;
    options.frames = frames;
    const Measurement measured = measure(options);
    if (!all_agree(measured.runs)) throw std::runtime_error("not all found the same pairs");
    for (const Run& run : measured.runs) {
      sizes_of(growths, run.engine)
          .push_back({objects, run.median_ms(), measured.bytes_per_object(run)});
    }
  }
  return growths;
}

void Growth::print(const std::string& scene, const Growths& growths) const {
  const int threads = choice.threads.front();
  std::cout << '\n'
            << scene << ", " << threads << (threads == 1 ? " thread, " : " threads, ") << isa_name()
            << ": median ms a frame (bytes an object)\n";
  std::vector<std::string> header{"partition"};
  for (const std::size_t objects : choice.objects) header.push_back(grouped(objects));
  header.emplace_back("exponent");
  Table table(std::move(header));
  for (const auto& [partition, sizes] : growths) {
    std::vector<std::string> row{partition};
    std::size_t next = 0;
    for (const std::size_t objects : choice.objects) {
      const bool has = next < sizes.size() && sizes[next].objects == objects;
      row.push_back(has ? short_number(sizes[next].ms) + " (" +
                              short_number(sizes[next].bytes_per_object) + ")"
                        : "-");
      next += has ? 1 : 0;
    }
    row.push_back(sizes.size() > 1 ? short_number(exponent_of(sizes)) : "-");
    table.add(std::move(row));
  }
  std::cout << table << std::flush;
}

Plot plot_of(const std::string& scene, const Growths& growths, bool bytes) {
  Plot plot;
  plot.id = scene + (bytes ? "_bytes" : "_time");
  plot.title = scene + (bytes ? ": memory" : ": time");
  plot.x = {"objects", true};
  plot.y = {bytes ? "bytes an object" : "microseconds an object and frame", true};
  for (const auto& [partition, sizes] : growths) {
    PlotSeries series{partition, {}, true};
    for (const Size& size : sizes) {
      const double us = 1e3 * size.ms / static_cast<double>(size.objects);
      const double y = bytes ? size.bytes_per_object : us;
      if (!(y > 0.0)) continue;
      series.points.push_back({static_cast<double>(size.objects), y,
                               grouped(size.objects) + " objects, " +
                                   (bytes ? short_number(y) + " bytes an object"
                                          : short_number(size.ms) + " ms a frame")});
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

int Growth::run() {
  choose_isa(choice.isa);
  if (choice.scenes.empty()) choice.scenes = {"uniform"};
  if (choice.objects.empty()) {
    choice.objects = {1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000};
  }
  if (choice.threads.empty()) choice.threads = {1};
  if (choice.threads.size() > 1) throw ArgumentError("--threads: one number, please");
  Json rows = Json::array();
  std::vector<Plot> plots;
  std::string body = "<h1>winnow: growth</h1>\n";
  Progress progress(choice.scenes.size() * choice.objects.size());
  for (const std::string& scene : choice.scenes) {
    const Growths growths = measure_scene(scene, progress);
    progress.clear();
    print(scene, growths);
    for (const auto& [partition, sizes] : growths) {
      for (const Size& size : sizes) {
        rows.push_back({{"scene", scene},
                        {"partition", partition},
                        {"threads", choice.threads.front()},
                        {"isa", isa_name()},
                        {"objects", size.objects},
                        {"median_ms", size.ms},
                        {"bytes_per_object", size.bytes_per_object}});
      }
    }
    for (const bool bytes : {false, true}) {
      plots.push_back(plot_of(scene, growths, bytes));
      body += place_of(plots.back());
    }
  }
  write_json(json, rows);
  if (!out.empty()) write_plot_page(out, "winnow: growth", body, plots);
  return kDone;
}

}  // namespace

Command add_growth(CLI::App& app) {
  auto growth = std::make_shared<Growth>();
  CLI::App* sub = app.add_subcommand(
      "growth", "Time and memory of every partition from 1,000 to 1,000,000 objects");
  add_scenes_option(*sub, growth->choice);
  add_objects_option(*sub, growth->choice);
  add_threads_option(*sub, growth->choice);
  add_partitions_option(*sub, growth->choice);
  add_isa_option(*sub, growth->choice);
  add_seed_option(*sub, growth->choice);
  add_frames_option(*sub, growth->frames);
  sub->add_option("--out", growth->out, "Also plot it, on an HTML page");
  add_json_option(*sub, growth->json);
  return {sub, [growth] { return growth->run(); }};
}

}  // namespace winnow::bench
