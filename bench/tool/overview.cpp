#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <algorithm>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

constexpr std::size_t kSizes[] = {10'000, 100'000};

MeasureOptions race_of(const std::string& scene, std::size_t objects, int threads) {
  MeasureOptions options;
  options.scene = scene;
  options.objects = objects;
  options.threads = {threads};
  // Other libraries are slower by an order of magnitude: once, with all cores, is enough here.
  options.peers = has_peers() && threads == usual_threads().back();
  options.frames = objects <= 10'000 ? 31 : options.peers ? 6 : 13;
  return options;
}

/// One table: a row an engine, a column a scene, and what all of them found at the bottom.
class SizeReport {
 public:
  SizeReport(std::size_t objects, int threads) : objects_(objects), threads_(threads) {}

  void add(const Measurement& measured) {
    scenes_.push_back(measured.scene);
    for (const Run& run : measured.runs) {
      if (std::find(engines_.begin(), engines_.end(), run.engine) == engines_.end()) {
        engines_.push_back(run.engine);
      }
      ms_[run.engine].resize(scenes_.size(), "-");
      ms_[run.engine].back() = short_number(run.median_ms());
      bytes_[run.engine] = std::max(bytes_[run.engine], measured.bytes_per_object(run));
    }
    const bool same = all_agree(measured.runs);
    all_same_ = all_same_ && same;
    pairs_.push_back(grouped(static_cast<std::size_t>(measured.runs.front().pairs_a_frame())));
    same_.emplace_back(same ? "yes" : "NO");
    skipped_ = measured.skipped;
  }

  [[nodiscard]] bool all_same() const noexcept { return all_same_; }

  void print() {
    std::cout << '\n'
              << grouped(objects_) << " objects, " << threads_
              << (threads_ == 1 ? " thread" : " threads") << ": ms a frame, median\n";
    Table table(with_label("", scenes_, "bytes/object"));
    for (const std::string& engine : engines_) {
      ms_[engine].resize(scenes_.size(), "-");
      const double bytes = bytes_[engine];
      table.add(with_label(engine, ms_[engine], bytes > 0.0 ? short_number(bytes) : "-"));
    }
    table.add(with_label("pairs a frame", pairs_, ""));
    table.add(with_label("same pairs from all", same_, ""));
    std::cout << table << skipped_line(skipped_) << std::flush;
  }

 private:
  static std::vector<std::string> with_label(const std::string& label,
                                             std::vector<std::string> cells,
                                             const std::string& last) {
    cells.insert(cells.begin(), label);
    cells.push_back(last);
    return cells;
  }

  std::size_t objects_;
  int threads_;
  std::vector<std::string> scenes_;
  std::vector<std::string> engines_;
  std::map<std::string, std::vector<std::string>> ms_;
  std::map<std::string, double> bytes_;
  std::vector<std::string> pairs_;
  std::vector<std::string> same_;
  std::vector<std::string> skipped_;
  bool all_same_ = true;
};

}  // namespace

int run_overview() {
  const std::vector<std::string> scenes = main_scenes();
  const std::vector<int> all_threads = usual_threads();
  Progress progress(std::size(kSizes) * all_threads.size() * scenes.size());
  std::cout << "Every pair of overlapping boxes, each frame: what moved is brought in, all pairs "
               "are written out.\nInstruction set "
            << isa_name() << ".\n";
  bool same = true;
  for (const std::size_t objects : kSizes) {
    for (const int threads : all_threads) {
      SizeReport report(objects, threads);
      for (const std::string& scene : scenes) {
        progress.step(scene + ", " + grouped(objects) + " objects, " + std::to_string(threads) +
                      (threads == 1 ? " thread" : " threads"));
        report.add(measure(race_of(scene, objects, threads)));
      }
      progress.clear();
      report.print();
      same = same && report.all_same();
    }
  }
  std::cout << "\nbytes/object: the most over the scenes, everything but the pairs found.\n"
               "More: winnow throughput | replay | footprint | keys | crossover | goals, each with "
               "--help.\n";
  return same ? kDone : kFailed;
}

}  // namespace winnow::bench
