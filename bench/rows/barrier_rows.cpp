#include "bench/rows/barrier_rows.h"

#include <winnow/simd/isa.h>
#include "bench/common/sample.h"
#include "bench/measure/fingerprint.h"
#include "bench/simulation/cloth_drop.h"
#include "bench/simulation/fast_bodies.h"

namespace winnow::bench {
namespace {

std::string barrier_command(const BarrierRowOptions& row_options) {
  std::string text = "bench/run simulate --barrier " + row_options.scene + " --steps " +
                     std::to_string(row_options.steps) + " --threads " +
                     std::to_string(row_options.threads) + " --isa " + isa_name();
  if (row_options.size != 0) text += " --objects " + std::to_string(row_options.size);
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
bool add_row(Results& results, const BarrierRowOptions& row_options, const Simulation& simulation,
             const std::vector<double>& ms, Json row) {
  row["scene"] = row_options.scene;
  row["steps"] = simulation.steps();
  row["impacts"] = simulation.impacts();
  row["passed"] = simulation.passed();
  row["cut_short"] = simulation.cut_short();
  row["ms"] = to_value(ms);
  row["fingerprint"] = to_hex(simulation.fingerprint());
  row["command"] = barrier_command(row_options);
  results.add("barriers", std::move(row));
  return simulation.passed() == 0;
}

}  // namespace

bool add_barrier(Results& results, const BarrierRowOptions& row_options) {
  const Execution execution =
      row_options.threads == 1 ? Execution::serial() : Execution::parallel();
  if (row_options.scene == "cloth") {
    ClothOptions options{.execution = execution};
    if (row_options.size != 0) options.side = row_options.size;
    ClothDrop cloth(options);
    const std::vector<double> ms = run(cloth, row_options.steps);
    return add_row(results, row_options, cloth, ms,
                   {{"objects", cloth.triangles()}, {"stretch", cloth.max_strain()}});
  }
  FastBodiesOptions options{.execution = execution};
  options.scene = row_options.scene == "blade" ? FastScene::blade : FastScene::funnel;
  options.bodies = row_options.size != 0 ? row_options.size : 16;
  FastBodies bodies(options);
  const std::vector<double> ms = run(bodies, row_options.steps);
  return add_row(results, row_options, bodies, ms,
                 {{"objects", bodies.bodies()}, {"fastest", bodies.fastest()}});
}

std::vector<std::string> barrier_names() {
  return {"funnel", "blade", "cloth"};
}

}  // namespace winnow::bench
