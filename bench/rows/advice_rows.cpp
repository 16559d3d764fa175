#include "bench/rows/advice_rows.h"

#include <winnow/simd/isa.h>

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr const char* kChooser = "AutoPartition";

/// Returns the fastest partition of the ranking except AutoPartition and the advised partition;
/// null if there is none.
const Advised* next_best(const Advice& advice) {
  const auto at =
      std::find_if(advice.ranking.begin(), advice.ranking.end(), [&](const Advised& one) {
        return one.partition != kChooser && one.partition != advice.best().partition;
      });
  return at == advice.ranking.end() ? nullptr : &*at;
}

/// Keys of the scene that is advised on, and the command that repeats the measurement.
struct AdvicePlace {
  Json keys;
  std::string command;

  void add_ranked(Results& results, const Advised& one) const {
    Json row = keys;
    row["partition"] = one.partition;
    row["frame_ms"] = to_value(one.settled);
    row["first_ms"] = one.first_ms;
    row["bytes_per_object"] = static_cast<double>(one.bytes) / keys["objects"].get<double>();
    row["why"] = one.why;
    row["command"] = command;
    results.add("advice_ranking", std::move(row));
  }
};

void add_ranking(Results& results, const AdvicePlace& place, const Advice& advice) {
  const Advised* next = next_best(advice);
  Json row = place.keys;
  row["take"] = word_of(advice.best().partition);
  row["moving"] = advice.moving;
  row["pairs_per_object"] = advice.pairs / static_cast<double>(advice.objects);
  row["why"] = advice.best().why;
  row["code"] = advice.code();
  row["command"] = place.command;
  bool has_chooser = false;
  for (const Advised& one : advice.ranking) {
    place.add_ranked(results, one);
    if (one.partition != kChooser) continue;
    has_chooser = true;
    row["auto_over_best"] = one.times_best;
  }
  if (next != nullptr) {
    row["next"] = word_of(next->partition);
    row["next_over_best"] = next->times_best;
  }
  if (has_chooser) {
    row["auto_holds"] = word_of(advice.chosen);
    row["auto_why"] = advice.reason;
  }
  results.add("advice", std::move(row));
}

}  // namespace

Advice add_advice(Results& results, const NamedScene& scene, std::size_t objects,
                  std::uint64_t seed, const std::vector<std::string>& partitions,
                  std::size_t frames, int threads) {
  const auto source = scene.source(objects, seed);
  Advice advice = advise(*source, partitions, frames, threads);
  std::string command = "bench/run advise " + shell_word(scene.argument);
  if (!scene.is_recording()) {
    command += " --objects " + std::to_string(objects) + " --seed " + std::to_string(seed);
  }
  command += " --threads " + std::to_string(threads) + " --isa " + isa_name() + " --frames " +
             std::to_string(frames);
  add_ranking(results,
              {{{"scene", scene.name}, {"objects", advice.objects}, {"threads", threads}}, command},
              advice);
  if (!advice.same_pairs) throw std::runtime_error("not all found the same pairs");
  return advice;
}

}  // namespace winnow::bench
