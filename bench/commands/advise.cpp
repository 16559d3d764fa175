#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/rows/rows.h"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace winnow::bench {
namespace {

constexpr std::size_t kAdviceFrames = 41;
constexpr std::size_t kMaxFrames = 201;

class Advise final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    target_.add_to(app);
    add_threads_option(app, threads_);
    add_partitions_option(app, partitions_);
    add_frames_option(app, frames_);
    add_rows_options(app);
  }

 private:
  void measure() override;

  Target target_;
  std::size_t frames_ = 0;  // 0: chosen by `measure`
  int threads_ = 1;
  std::vector<std::string> partitions_{"all"};
};

void print_choice(const Advice& advice) {
  const SceneFeatures& f = advice.features;
  std::cout << '\n'
            << short_number(100.0 * advice.moving) << " % of the objects move in a frame; "
            << short_number(advice.pairs / static_cast<double>(advice.objects))
            << " pairs an object";
  // Features are set only if AutoPartition was among the contenders.
  if (!advice.chosen.empty()) {
    std::cout << "; the large ones have " << short_number(std::exp2(f.size_spread))
              << " times the edges of the small ones; room for " << short_number(f.room[0]) << " x "
              << short_number(f.room[1]) << " x " << short_number(f.room[2])
              << " of them; crowding " << short_number(std::exp2(f.crowding))
              << "\nAutoPartition chose " << advice.chosen << ": " << advice.reason;
  }
  std::cout << "\n\n  #include <winnow/partitions/partition.h>\n  " << advice.code() << '\n';
}

void Advise::measure() {
  const NamedScene scene = target_.named();
  const std::size_t count = scene.objects(target_.objects.value_or(kSceneObjects));
  const Partitions partitions = partitions_for(partitions_, count);
  if (frames_ == 0) {
    frames_ =
        scene.is_recording() ? std::min(scene.recording->frames.size(), kMaxFrames) : kAdviceFrames;
  }
  plan(1);
  Advice advice;
  step(scene.name, [&] {
    advice = add_advice(results, scene, count, target_.seed.value_or(1), partitions.taken, frames_,
                        threads_);
  });
  print("advice_ranking");
  if (!partitions.skipped.empty()) std::cout << "skipped: " << listed(partitions.skipped) << '\n';
  if (!advice.ranking.empty()) print_choice(advice);
}

}  // namespace

void add_advise(CLI::App& app) {
  command<Advise>(
      app, "advise", "Measures all structures on a recording or scene and recommends one",
      "Structures take turns. Prints the reason for the recommendation, and the line of "
      "C++ that creates it. Medians exclude the first six frames.");
}

}  // namespace winnow::bench
