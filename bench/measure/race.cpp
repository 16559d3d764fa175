// Races partitions and other libraries over the frames of a scene, in blocks of frames, and checks
// that all find the same pairs. bench/rows, the commands replay and fit, and advice.cpp call it.

#include "bench/measure/race.h"

#include "bench/common/arena.h"
#include "bench/common/table.h"
#include "bench/contenders/partition_engine.h"
#include "bench/measure/isa_guard.h"
#include "bench/peers/peers.h"
#include "bench/peers/yardstick.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace winnow::bench {

namespace {

struct Frame {
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> changed;  // rows of the previous frame whose boxes differ
};

/// Reads a source in blocks of frames.
class FrameBlocks {
 public:
  explicit FrameBlocks(FrameSource& source) : source_(source) {}

  /// Returns at most `count` frames; empty at the end.
  const std::vector<Frame>& next(std::size_t count) {
    frames_.clear();
    while (frames_.size() < count) {
      if (started_ && !source_.advance()) break;
      started_ = true;
      const std::span<const Aabb> boxes = source_.boxes();
      Frame& frame = frames_.emplace_back();
      for (std::size_t i = 0; i < last_.size(); ++i) {
        if (std::memcmp(&boxes[i], &last_[i], sizeof(Aabb)) != 0) {
          frame.changed.push_back(static_cast<std::uint32_t>(i));
        }
      }
      frame.boxes.assign(boxes.begin(), boxes.end());
      last_ = frame.boxes;
    }
    return frames_;
  }

 private:
  FrameSource& source_;
  std::vector<Frame> frames_;
  std::vector<Aabb> last_;
  bool started_ = false;
};

/// Returns whether a contender runs another frame.
bool goes_on(const Run& run, const TimeBounds& bounds) {
  if (run.gave_up_ms > 0.0) return false;
  constexpr std::size_t kFewest = 3;  // not counting the first
  if (bounds.run == 0.0 || run.frame_ms.size() <= kFewest) return true;
  return std::accumulate(run.frame_ms.begin() + 1, run.frame_ms.end(), 0.0) < 1e3 * bounds.run;
}

void run_frame(Contender& contender, const Frame& frame, bool first, Run& run) {
  const Stopwatch clock;
  try {
    if (first) {
      contender.engine->start(frame.boxes);
    } else {
      contender.engine->frame(frame.changed, frame.boxes);
    }
  } catch (const GaveUp&) {
    run.gave_up_ms = clock.ms();
    return;
  }
  run.frame_ms.push_back(clock.ms());
  run.changed.push_back(frame.changed.size());
  run.update_ms.push_back(contender.engine->update_ms());
  run.pairs.push_back(summarize(contender.engine->pairs(), frame.boxes));
}

std::span<const double> after_first(const std::vector<double>& values) {
  return std::span(values).subspan(values.size() > 1 ? 1 : 0);
}

double mean_after_first(const std::vector<PairSummary>& frames,
                        std::uint64_t PairSummary::*member) {
  const std::size_t first = frames.size() > 1 ? 1 : 0;
  double sum = 0.0;
  for (std::size_t f = first; f < frames.size(); ++f) {
    sum += static_cast<double>(frames[f].*member);
  }
  return frames.empty() ? 0.0 : sum / static_cast<double>(frames.size() - first);
}

}  // namespace

std::span<const double> Run::settled_ms() const noexcept {
  return std::span(frame_ms).subspan(std::min(kSettlingFrames, frame_ms.size()));
}
Spread Run::frame_spread() const {
  return spread_of(after_first(frame_ms));
}
double Run::median_update_ms() const {
  return median_of(after_first(update_ms));
}
double Run::pairs_a_frame() const {
  return mean_after_first(pairs, &PairSummary::pairs);
}
double Run::reported_a_frame() const {
  return mean_after_first(pairs, &PairSummary::reported);
}

bool Run::same_pairs(const Run& other) const noexcept {
  const auto frames = static_cast<std::ptrdiff_t>(std::min(pairs.size(), other.pairs.size()));
  return std::equal(pairs.begin(), pairs.begin() + frames, other.pairs.begin(),
                    [](const PairSummary& a, const PairSummary& b) { return a.same_pairs(b); });
}

std::vector<Run> race(FrameSource& source, std::vector<Contender>& contenders,
                      const RaceOptions& options) {
  const IsaGuard guard;
  int most_threads = 1;
  for (const Contender& c : contenders) most_threads = std::max(most_threads, c.threads);
  Arenas arenas(most_threads);
  std::vector<Run> runs(contenders.size());
  for (std::size_t c = 0; c < contenders.size(); ++c) {
    runs[c].engine = contenders[c].engine->name();
    runs[c].threads = contenders[c].threads;
    runs[c].isa = contenders[c].isa;
    if (options.bounds.frame > 0.0) contenders[c].engine->give_up_after(1e3 * options.bounds.frame);
  }
  FrameBlocks blocks(source);
  for (std::size_t done = 0; done < options.frames;) {
    const std::size_t requested = done == 0 ? 1 : std::min(options.block, options.frames - done);
    const std::vector<Frame>& frames = blocks.next(requested);
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      IsaGuard::choose(contenders[c].isa);
      arenas.run(contenders[c].threads, [&] {
        for (const Frame& frame : frames) {
          if (goes_on(runs[c], options.bounds)) {
            run_frame(contenders[c], frame, done == 0, runs[c]);
          }
        }
      });
    }
    done += frames.size();
    if (frames.size() < requested) break;
  }
  for (std::size_t c = 0; c < contenders.size(); ++c) runs[c].bytes = contenders[c].engine->bytes();
  return runs;
}

std::vector<Contender> make_contenders(const std::vector<std::string>& partitions, int threads) {
  std::vector<Contender> contenders;
  for (const std::string& name : partitions) {
    contenders.push_back({std::make_unique<PartitionEngine>(name, threads), threads, active_isa()});
  }
  return contenders;
}

bool all_agree(const std::vector<Run>& runs) noexcept {
  return std::all_of(runs.begin(), runs.end(),
                     [&](const Run& run) { return run.same_pairs(runs.front()); });
}

namespace {

/// Returns the reason why a library is left out of a race; empty if it is not left out.
std::string why_skipped(const Engine& engine, const MeasureOptions& options,
                        const Measurement& result) {
  if (result.objects <= engine.largest() || options.bounds.any()) return {};
  return engine.name() + " (more than " + grouped(engine.largest()) + " objects)";
}

/// Adds the other libraries. Serial ones are added only once, for all numbers of threads.
void add_peers(const MeasureOptions& options, std::vector<Contender>& contenders,
               Measurement& result) {
  for (const int threads : options.threads) {
    for (std::unique_ptr<Engine>& engine : make_peers(threads)) {
      if (engine->is_serial() && threads != options.threads.front()) continue;
      const std::string text = why_skipped(*engine, options, result);
      if (text.empty()) {
        contenders.push_back({std::move(engine), threads, active_isa()});
      } else if (std::find(result.skipped.begin(), result.skipped.end(), text) ==
                 result.skipped.end()) {
        result.skipped.push_back(text);
      }
    }
  }
}

void add_yardstick(const MeasureOptions& options, std::vector<Contender>& contenders) {
  for (const int threads : options.threads) {
    std::unique_ptr<Engine> engine = make_yardstick(threads);
    if (engine != nullptr) contenders.push_back({std::move(engine), threads, active_isa()});
  }
}

}  // namespace

Measurement measure(const MeasureOptions& options) {
  const auto source = options.recording != nullptr
                          ? play(*options.recording)
                          : scene_or_error(options.scene, options.objects, options.seed);
  Measurement result;
  result.scene = source->name();
  result.objects = source->objects();
  result.grows = source->objects() > source->boxes().size();
  const Partitions partitions = partitions_for(options.partitions, result.objects);
  result.skipped = partitions.skipped;

  std::vector<Contender> contenders;
  std::vector<Isa> isas = options.isas;
  if (isas.empty()) isas.push_back(active_isa());
  for (const Isa isa : isas) {
    for (const int threads : options.threads) {
      for (Contender& contender : make_contenders(partitions.taken, threads)) {
        contender.isa = isa;
        contenders.push_back(std::move(contender));
      }
    }
  }
  result.partition_runs = contenders.size();
  if (options.peers) add_peers(options, contenders, result);
  if (options.yardstick) add_yardstick(options, contenders);
  result.peer_runs = contenders.size() - result.partition_runs;

  result.runs = race(*source, contenders,
                     {.frames = options.frames != 0 ? options.frames : frames_for(result.objects),
                      .bounds = options.bounds});
  return result;
}

std::size_t frames_for(std::size_t objects) {
  if (objects <= 2'000) return 121;
  if (objects <= 20'000) return 61;
  return objects <= 300'000 ? 13 : 6;
}

}  // namespace winnow::bench
