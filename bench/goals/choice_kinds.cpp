#include "advice/advice.h"
#include "engine/partition_engine.h"
#include "goals/kinds.h"
#include "recordings/recording.h"
#include "scenes/scene.h"
#include "tool/arguments.h"
#include "tool/table.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <system_error>

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

std::vector<Goal> judge(const Ask& ask, const Measurement& cell, int threads) {
  std::vector<const Run*> runs;
  for (const Run& run : cell.partitions()) {
    if (run.threads == threads) runs.push_back(&run);
  }
  const auto chooser =
      std::find_if(runs.begin(), runs.end(), [](auto* run) { return is_auto(*run); });
  if (chooser == runs.end() || runs.size() < 2) ask.fail("AutoPartition and others must run");
  const Run& own = **chooser;
  const Run& best = least(runs, settled_ms);
  const auto first = [](const Run& run) { return sum_of(run, 0, kFirst); };
  const Run& quickest = least(runs, first);
  const std::string where = cell.scene + ", " + on_size(cell.objects, threads);
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
       .measured = first(own) / first(quickest),
       .detail = short_number(first(own)) + " ms; best is " + quickest.engine + ", " +
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
  return judge(ask, cell, ask.threads());
}

std::vector<Goal> choice_in_recordings(const Ask& ask, const std::vector<Ask>& /*all*/,
                                       Lab& /*lab*/) {
  std::vector<std::filesystem::path> files;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(ask.text("folder"), absent)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".aabbs") || name.ends_with(".aabbs.xz")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Goal> goals;
  for (const std::filesystem::path& file : files) {
    const Recording recording = read_recording(file.string());
    MeasureOptions options;
    options.recording = &recording;
    options.frames = std::min(recording.frames.size(), ask.count("frames"));
    options.threads = {ask.threads()};
    for (Goal& goal : judge(ask, measure(options), ask.threads())) goals.push_back(std::move(goal));
  }
  return goals;
}

std::vector<Goal> choice_turn(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& /*lab*/) {
  const auto scenes = ask.get<std::vector<std::string>>("scenes");
  const std::size_t each = ask.count("frames_each");
  TurningScene scene(scenes, ask.count("objects"), each);
  std::vector<Contender> contenders =
      make_contenders(partitions_for({"all"}, ask.count("objects")).taken, ask.threads());
  RaceOptions options;
  options.frames = each * scenes.size();
  options.block = 1;
  const std::vector<Run> runs = race(scene, contenders, options);
  std::vector<const Run*> all;
  for (const Run& run : runs) all.push_back(&run);
  const auto own = std::find_if(all.begin(), all.end(), [](auto* run) { return is_auto(*run); });
  if (own == all.end()) ask.fail("AutoPartition must run");
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
         .measured = (sum(**own) - sum(best)) / frame,
         .detail = "best is " + best.engine + ", " + short_number(frame) + " ms a frame"});
  }
  return goals;
}

}  // namespace winnow::bench
