#include "tool/measure.h"

#include "engine/partition_engine.h"
#include "engine/reference_sweep.h"
#include "tool/arguments.h"
#include "tool/table.h"

#include <algorithm>
#include <limits>
#include <optional>

#if WINNOW_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace winnow::bench {
namespace {

std::vector<std::unique_ptr<Engine>> peers_for([[maybe_unused]] int threads) {
#if WINNOW_HAVE_PEERS
  return make_peers(threads);
#else
  return {};
#endif
}

void add_peers(const MeasureOptions& options, std::vector<Contender>& contenders,
               Measurement& result) {
  std::vector<std::string>& skipped = result.skipped;
  for (const int threads : options.threads) {
    for (std::unique_ptr<Engine>& engine : peers_for(threads)) {
      if (result.objects > engine->largest()) {
        const std::string text =
            engine->name() + " (more than " + grouped(engine->largest()) + " objects)";
        if (std::find(skipped.begin(), skipped.end(), text) == skipped.end()) {
          skipped.push_back(text);
        }
      } else {
        contenders.push_back({std::move(engine), threads, active_isa()});
      }
    }
  }
}

const Run* fastest_of(std::span<const Run> runs, int threads) {
  const Run* best = nullptr;
  for (const Run& run : runs) {
    if (run.threads != threads) continue;
    if (best == nullptr || run.median_ms() < best->median_ms()) best = &run;
  }
  return best;
}

}  // namespace

const Run* Measurement::find(const std::string& engine, int threads) const {
  for (const Run& run : runs) {
    if (run.engine == engine && run.threads == threads) return &run;
  }
  return nullptr;
}

const Run* Measurement::fastest(int threads) const {
  return fastest_of(partitions(), threads);
}
const Run* Measurement::fastest_peer(int threads) const {
  return fastest_of(peers(), threads);
}

Measurement measure(const MeasureOptions& options) {
  const auto source = options.recording != nullptr
                          ? play(*options.recording)
                          : scene_or_error(options.scene, options.objects, options.seed);
  Measurement result;
  result.scene = source->name();
  result.objects = source->boxes().size();
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
  result.peer_runs = contenders.size() - result.partition_runs;
  if (options.reference) {
    contenders.push_back({std::make_unique<ReferenceSweep>(-1), 1, active_isa()});
  }

  RaceOptions race_options;
  race_options.frames = options.frames != 0 ? options.frames : frames_for(result.objects);
  std::optional<MachineClock> clock;
  if (options.machine_clock) {
    clock.emplace();
    race_options.before_block = [&](std::size_t) { clock->tick(); };
  }
  result.runs = race(*source, contenders, race_options);
  if (clock) {
    clock->tick();
    result.machine_ms = clock->median_ms();
  }
  return result;
}

std::size_t frames_for(std::size_t objects) {
  if (objects <= 20'000) return 31;
  return objects <= 300'000 ? 13 : 6;
}

bool has_peers() {
#if WINNOW_HAVE_PEERS
  return true;
#else
  return false;
#endif
}

}  // namespace winnow::bench
