#include "bench/contenders/partitions.h"
#include "bench/goals/choice.h"
#include "bench/goals/measurements.h"
#include "bench/measure/advice.h"
#include "bench/rows/frame_rows.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::string_view kAuto = "AutoPartition";
constexpr std::size_t kFirst = 6;  // frames until a choice should have settled

using RunSpan = std::span<const Run>;

double sum_of_frames(const Run& run, std::size_t begin, std::size_t end) {
  const auto at = run.frame_ms.begin();
  return std::accumulate(at + static_cast<std::ptrdiff_t>(begin),
                         at + static_cast<std::ptrdiff_t>(std::min(end, run.frame_ms.size())), 0.0);
}

std::vector<const Run*> on_threads(RunSpan runs, int threads) {
  std::vector<const Run*> chosen;
  for (const Run& run : runs) {
    if (run.threads == threads) chosen.push_back(&run);
  }
  return chosen;
}

/// AutoPartition's, and of the others that `cost` is least of.
struct OwnAndBest {
  const Run* own = nullptr;
  const Run* best = nullptr;
};

template <typename Cost>
OwnAndBest own_and_best(const std::vector<const Run*>& runs, Cost&& cost) {
  OwnAndBest found;
  for (const Run* run : runs) {
    const Run*& place = run->engine == kAuto ? found.own : found.best;
    if (place == nullptr || cost(*run) < cost(*place)) place = run;
  }
  if (found.own == nullptr || found.best == nullptr) {
    throw std::runtime_error("AutoPartition and others must run");
  }
  return found;
}

/// The median over the settled frames of one's time over the other's: neighbours in time, so that
/// what disturbs the machine disturbs both.
double settled_ratio(const Run& a, const Run& b) {
  std::vector<double> ratios;
  for (std::size_t f = std::min(kFirst, a.frame_ms.size() - 1); f < a.frame_ms.size(); ++f) {
    ratios.push_back(a.frame_ms[f] / b.frame_ms[f]);
  }
  return median_of(ratios);
}

/// Races all partitions on the same frames a few times over and keeps each frame's least time: sums
/// of few frames say nothing if one of them was disturbed.
template <typename MakeSource>
std::vector<Run> undisturbed(MakeSource&& make_source, std::size_t frames, int threads) {
  constexpr int kRounds = 3;
  std::vector<Run> runs;
  for (int round = 0; round < kRounds; ++round) {
    const std::unique_ptr<FrameSource> source = make_source();
    std::vector<Contender> contenders =
        make_contenders(partitions_for({"all"}, source->boxes().size()).taken, threads);
    RaceOptions options;
    options.frames = frames;
    options.block = 1;
    std::vector<Run> again = race(*source, contenders, options);
    if (runs.empty()) runs = again;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      for (std::size_t f = 0; f < runs[i].frame_ms.size(); ++f) {
        runs[i].frame_ms[f] = std::min(runs[i].frame_ms[f], again[i].frame_ms[f]);
      }
    }
  }
  return runs;
}

void add_choice(Results& results, const Json& keys, const OwnAndBest& of, double own_ms,
                double best_ms, double ratio) {
  Json row = keys;
  row.update({{"ratio", ratio}, {"ms", own_ms}, {"best", of.best->engine}, {"best_ms", best_ms}});
  results.add("choice", std::move(row));
}

template <typename MakeSource>
void add_first_choice(Results& results, const std::string& scene, std::size_t objects, int threads,
                      MakeSource&& make_source) {
  const std::vector<Run> runs = undisturbed(make_source, kFirst, threads);
  const auto first = [](const Run& run) { return sum_of_frames(run, 0, kFirst); };
  const OwnAndBest of = own_and_best(on_threads(runs, threads), first);
  add_choice(results,
             {{"scene", scene}, {"objects", objects}, {"threads", threads}, {"frames", "first"}},
             of, first(*of.own), first(*of.best), first(*of.own) / first(*of.best));
}

/// One scene after another with the same objects: a scene that changes its nature at once.
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

}  // namespace

void declare_choice(Results& results) {
  results.declare({"choice",
                   "choice",
                   "AutoPartition over the best",
                   {"scene", "objects", "threads", "frames"},
                   {{"ratio", "ratio", "times", Better::less},
                    {"ms", "AutoPartition", "ms"},
                    {"best", "best", "", Better::neither, Format::text},
                    {"best_ms", "its time", "ms"}}});
}

void add_settled_choice(Results& results, const std::string& scene, const Measurement& measured) {
  for (const int threads : {1, 2}) {
    const std::vector<const Run*> runs = on_threads(measured.partitions(), threads);
    if (runs.empty()) continue;
    const OwnAndBest of = own_and_best(runs, settled_ms);
    add_choice(results,
               {{"scene", scene},
                {"objects", measured.objects},
                {"threads", threads},
                {"frames", "settled"}},
               of, settled_ms(*of.own), settled_ms(*of.best), settled_ratio(*of.own, *of.best));
  }
}

void measure_first_frames(const Json& options, Lab& /*lab*/, Measured& measured) {
  const std::string scene = options.at("scene");
  const std::size_t objects = options.at("objects");
  declare_choice(measured.results);
  add_first_choice(measured.results, scene, objects, options.at("threads"),
                   [&] { return scene_or_error(scene, objects, 1); });
}

void measure_recorded_choice(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_choice(measured.results);
  declare_frames(measured.results);
  const std::vector<std::string> files = recordings_in(options.at("folder"));
  measured.absent = files.empty();
  const int threads = options.at("threads");
  for (const NamedScene& scene : named_scenes(files)) {
    const std::size_t frames =
        std::min(scene.recording->frames.size(), options.at("frames").get<std::size_t>());
    const Measurement raced =
        add_frame_race(measured.results, scene, {.threads = {threads}, .frames = frames});
    add_settled_choice(measured.results, scene.name, raced);
    add_first_choice(measured.results, scene.name, raced.objects, threads,
                     [&] { return play(*scene.recording); });
  }
}

void measure_changes(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"changes",
                            "choice",
                            "what AutoPartition loses after a scene has turned into another",
                            {"from", "into", "objects"},
                            {{"frames_lost", "lost", "frames of the best"},
                             {"best", "best", "", Better::neither, Format::text}}});
  const auto scenes = options.at("scenes").get<std::vector<std::string>>();
  const std::size_t each = options.at("frames_each");
  const std::size_t objects = options.at("objects");
  const int threads = options.at("threads");
  const auto make_source = [&]() -> std::unique_ptr<FrameSource> {
    return std::make_unique<TurningScene>(scenes, objects, each);
  };
  const std::vector<Run> runs = undisturbed(make_source, each * scenes.size(), threads);
  for (std::size_t turn = 1; turn < scenes.size(); ++turn) {
    const auto sum = [&](const Run& run) {
      return sum_of_frames(run, turn * each, (turn + 1) * each);
    };
    const OwnAndBest of = own_and_best(on_threads(runs, threads), sum);
    const double frame = sum(*of.best) / static_cast<double>(each);
    measured.results.add("changes", {{"from", scenes[turn - 1]},
                                     {"into", scenes[turn]},
                                     {"objects", objects},
                                     {"frames_lost", (sum(*of.own) - sum(*of.best)) / frame},
                                     {"best", of.best->engine}});
  }
}

}  // namespace winnow::bench
