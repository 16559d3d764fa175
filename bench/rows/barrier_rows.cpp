#include "bench/rows/barrier_rows.h"

#include <winnow/simd/isa.h>
#include "bench/common/sample.h"
#include "bench/measure/fingerprint.h"
#include "bench/simulation/cloth_drop.h"
#include "bench/simulation/fast_bodies.h"

namespace winnow::bench {
namespace {

std::string barrier_command(const BarrierRowOptions& asked) {
  std::string text = "bench/run simulate --barrier " + asked.scene + " --steps " +
                     std::to_string(asked.steps) + " --threads " + std::to_string(asked.threads) +
                     " --isa " + isa_name();
  if (asked.size != 0) text += " --objects " + std::to_string(asked.size);
  return text;
}

/// Returns the time of each step of a simulation in milliseconds.
template <typename Simulation>
std::vector<double> run(Simulation& simulation, std::size_t steps) {
  std::vector<double> ms;
  for (std::size_t i = 0; i < steps; ++i) {
    const Stopwatch clock;
    simulation.step();
    ms.push_back(clock.ms());
  }
  return ms;
}

template <typename Simulation>
bool add_row(Results& results, const BarrierRowOptions& asked, const Simulation& simulation,
             const std::vector<double>& ms, Json row) {
  row["scene"] = asked.scene;
  row["steps"] = simulation.steps();
  row["impacts"] = simulation.impacts();
  row["passed"] = simulation.passed();
  row["cut_short"] = simulation.cut_short();
  row["ms"] = to_value(ms);
  row["fingerprint"] = to_hex(simulation.fingerprint());
  row["command"] = barrier_command(asked);
  results.add("barriers", std::move(row));
  return simulation.passed() == 0;
}

}  // namespace

void declare_barriers(Results& results) {
  results.declare({"barriers",
                   "motion",
                   "what is fast, and what does not get through",
                   {"scene", "objects", "steps"},
                   {{"ms", "a step", "ms", Better::less},
                    {"fastest", "longest way in a step", "radii", Better::neither},
                    {"impacts", "impacts", "", Better::neither, Format::count},
                    {"passed", "passed through", "", Better::less, Format::count},
                    {"cut_short", "steps cut short", "", Better::less, Format::count},
                    {"stretch", "longest edge over its length at rest, less 1", "", Better::less},
                    {"fingerprint", "all bits", "", Better::neither, Format::text}}});
}

bool add_barrier(Results& results, const BarrierRowOptions& asked) {
  const Execution execution = asked.threads == 1 ? Execution::serial() : Execution::parallel();
  if (asked.scene == "cloth") {
    ClothOptions options{.execution = execution};
    if (asked.size != 0) options.side = asked.size;
    ClothDrop cloth(options);
    const std::vector<double> ms = run(cloth, asked.steps);
    return add_row(results, asked, cloth, ms,
                   {{"objects", cloth.triangles()}, {"stretch", cloth.stretch()}});
  }
  FastBodiesOptions options{.execution = execution};
  options.scene = asked.scene == "blade" ? FastScene::blade : FastScene::funnel;
  options.bodies = asked.size != 0 ? asked.size : 16;
  FastBodies bodies(options);
  const std::vector<double> ms = run(bodies, asked.steps);
  return add_row(results, asked, bodies, ms,
                 {{"objects", bodies.bodies()}, {"fastest", bodies.fastest()}});
}

std::vector<std::string> barrier_names() {
  return {"funnel", "blade", "cloth"};
}

}  // namespace winnow::bench
