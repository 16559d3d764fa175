// Races partitions and other libraries over the frames of a scene, in blocks of frames, and checks
// that all find the same pairs. bench/rows, the commands replay and fit, and advice.cpp call it.

#include "bench/measure/race.h"

#include "bench/common/arena.h"
#include "bench/common/table.h"
#include "bench/contenders/partition_engine.h"
#include "bench/measure/isa_guard.h"
#include "bench/peers/peers.h"
#include "bench/scenes/scene.h"

#include <algorithm>
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
      const auto boxes = source_.boxes();
      const auto changed = changes_.next(boxes);
      frames_.push_back({{boxes.begin(), boxes.end()}, {changed.begin(), changed.end()}});
    }
    return frames_;
  }

 private:
  FrameSource& source_;
  std::vector<Frame> frames_;
  ChangedRows changes_;
  bool started_ = false;
};

void run_frame(Contender& contender, const Frame& frame, bool first, Run& run) {
  const Stopwatch clock;
  if (first) {
    contender.engine->start(frame.boxes);
  } else {
    contender.engine->frame(frame.changed, frame.boxes);
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
std::span<const double> Run::later_ms() const noexcept {
  return after_first(frame_ms);
}
std::span<const double> Run::later_update_ms() const noexcept {
  return after_first(update_ms);
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
  }
  FrameBlocks blocks(source);
  for (std::size_t done = 0; done < options.frames;) {
    const std::size_t requested = done == 0 ? 1 : std::min(options.block, options.frames - done);
    const std::vector<Frame>& frames = blocks.next(requested);
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      IsaGuard::choose(contenders[c].isa);
      arenas.run(contenders[c].threads, [&] {
        for (const Frame& frame : frames) run_frame(contenders[c], frame, done == 0, runs[c]);
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

/// Adds the other libraries. Serial ones are added only once, for all numbers of threads.
void add_peers(const MeasureOptions& options, std::vector<Contender>& contenders,
               Measurement& result) {
  for (const int threads : options.threads) {
    for (std::unique_ptr<Engine>& engine : make_peers<Engine>(threads)) {
      if (engine->is_serial() && threads != options.threads.front()) continue;
      if (result.objects <= engine->largest()) {
        contenders.push_back({std::move(engine), threads, active_isa()});
        continue;
      }
      std::string text = engine->name() + " (more than " + grouped(engine->largest()) + " objects)";
      if (std::ranges::find(result.skipped, text) == result.skipped.end()) {
        result.skipped.push_back(std::move(text));
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
                     {.frames = options.frames != 0 ? options.frames : frames_for(result.objects)});
  return result;
}

std::size_t frames_for(std::size_t objects) {
  if (objects <= 2'000) return 121;
  if (objects <= 20'000) return 61;
  return objects <= 300'000 ? 13 : 6;
}

}  // namespace winnow::bench
