#include "advice/advice.h"
#include "engine/partition_engine.h"
#include "goals/kinds.h"
#include "recordings/recording.h"
#include "scenes/scene.h"
#include "tool/arguments.h"
#include "tool/table.h"

#include <algorithm>
#include <numeric>

namespace winnow::bench {
namespace {

constexpr std::string_view kAuto = "AutoPartition";
constexpr std::size_t kFirst = 6;  // frames until a choice should have settled

bool is_auto(const Run& run) {
  return run.engine == kAuto;
}

double sum_of(const Run& run, std::size_t begin, std::size_t end) {
  const auto at = run.frame_ms.begin();
  return std::accumulate(at + static_cast<std::ptrdiff_t>(begin),
                         at + static_cast<std::ptrdiff_t>(std::min(end, run.frame_ms.size())), 0.0);
}

/// The run other than AutoPartition's that `cost` is least of.
template <typename Cost>
const Run& least(const std::vector<const Run*>& runs, Cost&& cost) {
  const Run* best = nullptr;
  for (const Run* run : runs) {
    if (!is_auto(*run) && (best == nullptr || cost(*run) < cost(*best))) best = run;
  }
  return *best;
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

std::vector<const Run*> of_threads(std::span<const Run> runs, int threads) {
  std::vector<const Run*> chosen;
  for (const Run& run : runs) {
    if (run.threads == threads) chosen.push_back(&run);
  }
  return chosen;
}

const Run& own_run(const Ask& ask, const std::vector<const Run*>& runs) {
  const auto own =
      std::find_if(runs.begin(), runs.end(), [](const Run* run) { return is_auto(*run); });
  if (own == runs.end() || runs.size() < 2) ask.fail("AutoPartition and others must run");
  return **own;
}

template <typename MakeSource>
std::vector<Goal> judge(const Ask& ask, const Measurement& cell, MakeSource&& make_source) {
  const std::vector<const Run*> runs = of_threads(cell.partitions(), ask.threads());
  const Run& own = own_run(ask, runs);
  const Run& best = least(runs, settled_ms);
  const std::vector<Run> few = undisturbed(make_source, kFirst, ask.threads());
  const std::vector<const Run*> beginners = of_threads(few, ask.threads());
  const auto first = [](const Run& run) { return sum_of(run, 0, kFirst); };
  const Run& quickest = least(beginners, first);
  const double own_first = first(own_run(ask, beginners));
  const std::string where = cell.scene + ", " + on_size(cell.objects, ask.threads());
  return {
      {.what = where + ": AutoPartition over the best, settled frames",
       .unit = "ratio",
       .asked = ask.number("asked"),
       .measured = settled_ratio(own, best),
       .detail = short_number(settled_ms(own)) + " ms; best is " + best.engine + ", " +
                 short_number(settled_ms(best)) + " ms"},
      {.what = where + ": AutoPartition over the best, first " + std::to_string(kFirst) + " frames",
       .unit = "ratio",
       .asked = ask.number("asked_first"),
       .measured = own_first / first(quickest),
       .detail = short_number(own_first) + " ms; best is " + quickest.engine + ", " +
                 short_number(first(quickest)) + " ms"}};
}

/// One scene after another with the same objects: a scene that changes its nature at once.
class TurningScene final : public FrameSource {
 public:
  TurningScene(std::vector<std::string> scenes, std::size_t objects, std::size_t frames_each)
      : scenes_(std::move(scenes)), objects_(objects), frames_each_(frames_each) {
    turn_to(0);
  }

  [[nodiscard]] std::string name() const override {
    std::string text;
    for (const std::string& scene : scenes_) text += (text.empty() ? "" : " > ") + scene;
    return text;
  }
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

std::vector<Goal> choice_near_best(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const Measurement& cell = lab.cell(ask.text("scene"), ask.count("objects"));
  return judge(ask, cell, [&] { return scene_or_error(cell.scene, cell.objects, 1); });
}

std::vector<Goal> choice_in_recordings(const Ask& ask, const std::vector<Ask>& /*all*/,
                                       Lab& /*lab*/) {
  std::vector<Goal> goals;
  for (const std::string& file : recordings_in(ask.text("folder"))) {
    const Recording recording = read_recording(file);
    MeasureOptions options;
    options.recording = &recording;
    options.frames = std::min(recording.frames.size(), ask.count("frames"));
    options.threads = {ask.threads()};
    const Measurement measured = measure(options);
    for (Goal& goal : judge(ask, measured, [&] { return play(recording); })) {
      goals.push_back(std::move(goal));
    }
  }
  return goals;
}

std::vector<Goal> choice_turn(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& /*lab*/) {
  const auto scenes = ask.get<std::vector<std::string>>("scenes");
  const std::size_t each = ask.count("frames_each");
  const auto make_source = [&]() -> std::unique_ptr<FrameSource> {
    return std::make_unique<TurningScene>(scenes, ask.count("objects"), each);
  };
  const std::vector<Run> runs = undisturbed(make_source, each * scenes.size(), ask.threads());
  const std::vector<const Run*> all = of_threads(runs, ask.threads());
  const Run& own = own_run(ask, all);
  std::vector<Goal> goals;
  for (std::size_t turn = 1; turn < scenes.size(); ++turn) {
    const auto sum = [&](const Run& run) { return sum_of(run, turn * each, (turn + 1) * each); };
    const Run& best = least(all, sum);
    const double frame = sum(best) / static_cast<double>(each);
    goals.push_back(
        {.what = scenes[turn - 1] + " turns into " + scenes[turn] + ", " +
                 on_size(ask.count("objects"), ask.threads()) + ": what AutoPartition loses in " +
                 std::to_string(each) + " frames",
         .unit = "frames of the best",
         .asked = ask.number("asked"),
         .measured = (sum(own) - sum(best)) / frame,
         .detail = "best is " + best.engine + ", " + short_number(frame) + " ms a frame"});
  }
  return goals;
}

}  // namespace winnow::bench
