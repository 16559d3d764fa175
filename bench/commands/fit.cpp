// The command `winnow dev fit`: fits the cost constants of AutoPartition to times measured on this
// machine, and prints how far its choices are from the best. The fit itself is in measure/cost_fit.

#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/table.h"
#include "bench/measure/cost_fit.h"
#include "bench/measure/race.h"
#include "bench/scenes/scene.h"

#include <winnow/simd/isa.h>

#include <algorithm>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

struct Fit {
  std::vector<std::string> scenes = scene_names();
  std::vector<std::size_t> objects{50, 100, 200, 500, 1'000, 2'000, 5'000, 20'000, 100'000};
  std::vector<double> moving{1.0, 0.05, 0.01};
  std::size_t frames = 0;
  std::string isa;
  bool only_checks = false;

  void add_options(CLI::App& app);
  int run();
  [[nodiscard]] std::vector<CostSample> measured() const;
};

void Fit::add_options(CLI::App& app) {
  one_of(app, "--scene", scenes, scene_names(), "Scenes");
  add_objects_option(app, objects, "Numbers of objects");
  number(app, "--moving", moving, 1e-6, 1.0, "Shares of objects that move in a frame");
  number(app, "--frames", frames, 0, 1e6, "Number of frames; 0: chosen by the number of objects");
  add_isa_option(app, isa);
  app.add_flag("--check", only_checks,
               "Evaluate the present constants instead of fitting new ones");
}

std::vector<CostSample> Fit::measured() const {
  std::vector<CostSample> samples;
  for (const std::size_t count : objects) {
    for (const std::string& name : scenes) {
      for (const double share : moving) {
        const auto scene = some_moving(scene_or_error(name, count, 1), share);
        const std::size_t taken = frames != 0 ? frames : frames_for(count);
        samples.push_back(measure_costs(*scene, share, taken));
      }
      std::cerr << grouped(count) << ' ' << name << '\n';
    }
  }
  return samples;
}

void print_costs(const FittedCosts& fitted) {
  for (std::size_t k = 0; k < fitted.costs.size(); ++k) {
    const StructureCosts& c = fitted.costs[k];
    std::cout << candidates()[k].name() << ", median error "
              << short_number(100.0 * fitted.error[k]) << " %:\n ";
    for (const auto& [name, value] : {std::pair("frame", c.frame),
                                      {"keep", c.keep},
                                      {"object", c.object},
                                      {"level", c.level},
                                      {"crowd", c.crowd},
                                      {"square", c.square},
                                      {"pair", c.pair},
                                      {"moved", c.moved},
                                      {"rest", c.rest},
                                      {"build", c.build},
                                      {"build_level", c.build_level}}) {
      if (value != 0.0) std::cout << " ." << name << " = " << short_number(value) << ',';
    }
    std::cout << '\n';
  }
}

/// Prints the ratios of the time of the chosen partition to the time of the best one: median and
/// maximum, by number of objects.
void print_regret(const std::vector<CostSample>& samples, const std::vector<StructureCosts>& costs,
                  const std::string& title) {
  struct Regrets {
    std::vector<double> all;
    double worst = 0.0;
    std::string where;
  };
  std::map<std::size_t, Regrets> by_size;
  for (const CostSample& sample : samples) {
    std::size_t chosen = 0;
    std::size_t best = 0;
    const double regret = regret_of(sample, costs, chosen, best);
    Regrets& of_size = by_size[sample.features.objects];
    of_size.all.push_back(regret);
    if (regret <= of_size.worst) continue;
    of_size.worst = regret;
    of_size.where = sample.scene + ", " + short_number(100.0 * sample.moving) +
                    " % move: " + std::string(candidates()[chosen].name()) + " for " +
                    std::string(candidates()[best].name());
  }
  Table table({"objects", "median", "worst", "where"});
  table.flush_left(3);
  for (const auto& [size, regrets] : by_size) {
    table.add({grouped(size), short_number(median_of(regrets.all)), short_number(regrets.worst),
               regrets.where});
  }
  std::cout << title << '\n' << table << '\n';
}

int Fit::run() {
  choose_isa(isa);
  const std::vector<CostSample> samples = measured();
  print_regret(samples, present_costs(), "chosen structure / best structure, present constants");
  if (only_checks) return kDone;
  const FittedCosts fitted = fit_costs(samples);
  print_regret(samples, fitted.costs, "chosen structure / best structure, fitted constants");
  print_costs(fitted);
  return kDone;
}

}  // namespace

void add_fit(CLI::App& app) {
  command<Fit>(app, "fit",
               "Fits the constants of the cost model of the automatic structure to times measured "
               "here, and prints how much slower its choice is than the best structure");
}

}  // namespace winnow::bench
