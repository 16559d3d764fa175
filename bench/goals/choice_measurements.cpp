// Measurements for goals about AutoPartition and worst frames: the first frames of AutoPartition
// and its frames after a scene changes, compared with the best partition, and the worst frames of
// any partition, compared with the median. goals/measurements.cpp lists them.

#include "bench/goals/measurements.h"
#include "bench/goals/race_minima.h"
#include "bench/goals/scenes_of.h"
#include "bench/measure/race.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <numeric>

namespace winnow::bench {
namespace {

/// Sums of the times of AutoPartition and of the fastest other partition over a range of frames.
struct OwnAndBest {
  double own_ms = 0.0;
  double best_ms = 0.0;
  std::string best{};

  OwnAndBest(const std::vector<Run>& runs, std::size_t begin, std::size_t end) {
    for (const Run& run : runs) {
      const auto at = run.frame_ms.begin();
      const auto stop = static_cast<std::ptrdiff_t>(std::min(end, run.frame_ms.size()));
      const double ms = std::accumulate(at + static_cast<std::ptrdiff_t>(begin), at + stop, 0.0);
      if (run.engine == "AutoPartition") {
        own_ms = ms;
      } else if (best.empty() || ms < best_ms) {
        best_ms = ms;
        best = run.engine;
      }
    }
  }
};

/// A scene that changes abruptly: several scenes in sequence, with the same number of objects.
class TurningScene final : public FrameSource {
 public:
  TurningScene(std::vector<std::string> scenes, std::size_t objects, std::size_t frames_each)
      : scenes_(std::move(scenes)), objects_(objects), frames_each_(frames_each) {
    turn_to(0);
  }

  [[nodiscard]] std::string name() const override { return "turns"; }
  [[nodiscard]] Aabb world() const override { return source_->world(); }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return source_->boxes(); }
  bool advance() override {
    if (++frame_ % frames_each_ != 0) return source_->advance();
    if (frame_ / frames_each_ == scenes_.size()) return false;
    turn_to(frame_ / frames_each_);
    return true;
  }

 private:
  void turn_to(std::size_t scene) { source_ = scene_or_error(scenes_[scene], objects_, 1); }

  std::vector<std::string> scenes_;
  std::size_t objects_;
  std::size_t frames_each_;
  std::size_t frame_ = 0;
  std::unique_ptr<FrameSource> source_;
};

// Returns the times of the frames after settling in which something moved. Frames without motion
// are much cheaper and would distort the median.
std::vector<double> working_frames(const Run& run) {
  std::vector<double> working;
  for (std::size_t f = kSettlingFrames; f < run.frame_ms.size(); ++f) {
    if (run.changed[f] != 0) working.push_back(run.frame_ms[f]);
  }
  return working;
}

// Returns the greatest ratio of a frame to the median of the frames around it. The work of a scene
// may grow manyfold during a run, so a frame far above the median of all frames need not be a
// hitch.
double worst_hitch(std::span<const double> frames) {
  constexpr std::size_t kAround = 30;  // on each side
  double worst = 0.0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::size_t begin = f - std::min(f, kAround);
    const std::size_t end = std::min(frames.size(), f + kAround + 1);
    worst = std::max(worst, frames[f] / median_of(frames.subspan(begin, end - begin)));
  }
  return worst;
}

}  // namespace

void measure_first_frames(const Json& options, MeasurementCache& /*measurement_cache*/,
                          Measured& measured) {
  measured.results.declare({"first_frames",
                            "choice",
                            "the first frames of AutoPartition over those of the best",
                            {"scene", "objects", "threads"},
                            {{"ratio", "ratio", "times", Better::less},
                             {"ms", "AutoPartition", "ms"},
                             {"best", "best", "", Better::neither, Format::text},
                             {"best_ms", "its time", "ms"}}});
  const int threads = options.at("threads");
  for (const NamedScene& scene : scenes_of(options, measured)) {
    const std::size_t objects = scene.objects(options.value("objects", std::size_t{0}));
    const auto runs =
        race_minima([&] { return scene.source(objects, 1); }, {"all"}, kSettlingFrames, threads);
    const OwnAndBest of(runs, 0, kSettlingFrames);
    measured.results.add("first_frames", {{"scene", scene.name},
                                          {"objects", objects},
                                          {"threads", threads},
                                          {"ratio", of.own_ms / of.best_ms},
                                          {"ms", of.own_ms},
                                          {"best", of.best},
                                          {"best_ms", of.best_ms}});
  }
}

void measure_changes(const Json& options, MeasurementCache& /*measurement_cache*/,
                     Measured& measured) {
  measured.results.declare({"changes",
                            "choice",
                            "frames that AutoPartition loses after a change of the scene",
                            {"from", "into", "objects"},
                            {{"frames_lost", "lost", "frames of the best"},
                             {"best", "best", "", Better::neither, Format::text}}});
  const auto scenes = options.at("scenes").get<std::vector<std::string>>();
  const std::size_t each = options.at("frames_each");
  const std::size_t objects = options.at("objects");
  const auto runs =
      race_minima([&] { return std::make_unique<TurningScene>(scenes, objects, each); }, {"all"},
                  each * scenes.size(), options.at("threads"));
  for (std::size_t turn = 1; turn < scenes.size(); ++turn) {
    const OwnAndBest of(runs, turn * each, (turn + 1) * each);
    const double frame = of.best_ms / static_cast<double>(each);
    measured.results.add("changes", {{"from", scenes[turn - 1]},
                                     {"into", scenes[turn]},
                                     {"objects", objects},
                                     {"frames_lost", (of.own_ms - of.best_ms) / frame},
                                     {"best", of.best}});
  }
}

void measure_worst_frames(const Json& options, MeasurementCache& measurement_cache,
                          Measured& measured) {
  measured.results.declare({"worst_frames",
                            "scenes",
                            "the worst of many frames over the median one, and over the median of "
                            "those around it; of frames in which something moves, once settled",
                            {"scene", "objects", "partition", "threads"},
                            {{"ratio", "worst / median", "times", Better::less},
                             {"hitch", "worst / median around it", "times", Better::less},
                             {"worst_ms", "worst", "ms"},
                             {"median_ms", "median", "ms"},
                             {"frames", "frames", ""}}});
  const int threads = options.at("threads");
  for (const NamedScene& scene : scenes_of(options, measured)) {
    const std::size_t objects = scene.objects(options.value("objects", std::size_t{0}));
    const auto runs =
        race_minima([&] { return scene.source(objects, 1); }, options.at("partitions"),
                    kSettlingFrames + measurement_cache.worst_of(), threads);
    for (const Run& run : runs) {
      const std::vector<double> working = working_frames(run);
      if (working.empty()) continue;
      const Spread settled = spread_of(working);
      measured.results.add("worst_frames", {{"scene", scene.name},
                                            {"objects", objects},
                                            {"partition", run.engine},
                                            {"threads", threads},
                                            {"ratio", settled.max / settled.median},
                                            {"hitch", worst_hitch(working)},
                                            {"worst_ms", settled.max},
                                            {"median_ms", settled.median},
                                            {"frames", working.size()}});
    }
  }
}

}  // namespace winnow::bench
