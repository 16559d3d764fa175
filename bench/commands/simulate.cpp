// The command `winnow simulate`: runs a granular flow, bodies that stand on each other, or fast
// bodies at barriers, on winnow's scene, and checks the results. The simulations are in
// bench/simulation, the rows in bench/rows.

#include <winnow/simd/isa.h>
#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/common/arena.h"
#include "bench/common/table.h"
#include "bench/pages/page.h"
#include "bench/rows/machine.h"
#include "bench/rows/rows.h"

#include <algorithm>
#include <iostream>
#include <vector>

namespace winnow::bench {
namespace {

/// Number of steps of a flow that are announced.
constexpr std::size_t kReports = 20;
/// A larger relative rise of the energy makes the command fail.
constexpr double kMaxRise = 1e-3;

/// Selects every structure or barrier.
constexpr const char* kAll = "all";

/// Runs all steps and announces some of them.
void run_announced(FlowRun& run, std::size_t steps) {
  const std::size_t every = std::max<std::size_t>(1, steps / kReports);
  Progress progress(std::min(steps, kReports));
  for (std::size_t step = 0; step < steps; ++step) {
    if (step % every == 0) {
      const std::vector<FlowSample>& samples = run.history().samples();
      progress.step("step " + grouped(step) +
                    (samples.empty()
                         ? ""
                         : ", " + grouped(samples.back().contacts) + " contacts, " +
                               short_number(samples.back().times.total()) + " ms a step"));
    }
    run.step();
  }
}

class Simulate final : public RowsCommand {
 public:
  void add_options(CLI::App& app);

 private:
  void measure() override;
  void measure_standing();
  void measure_barriers();
  void measure_flow();

  FlowRowOptions options_{.objects = 10'000, .steps = 2'000, .threads = usual_threads().back()};
  std::string out_;
  std::string standing_;
  std::string barrier_;
  CLI::Option* objects_ = nullptr;
  CLI::Option* steps_ = nullptr;
  double seconds_ = StandingRowOptions{}.seconds;
};

void Simulate::add_options(CLI::App& app) {
  objects_ = number(app, "--objects", options_.objects, 1, 1e7,
                    "Number of bodies; for a cloth, vertices along an edge");
  steps_ = number(app, "--steps", options_.steps, 1, 1e8,
                  "Number of steps, of 1/1000 s; with --barrier, of 1/60 s");
  one_of(app, "--shape", options_.shape, flow_shape_names(), "Shapes of the bodies");
  option(app, "--out", out_, "HTML page to write, with plots over time");
  option(app, "--check", options_.check,
         "Interval in steps at which contacts are compared with a brute-force test of all pairs; "
         "0: never");
  std::vector<std::string> structures = standing_names();
  structures.emplace_back(kAll);
  one_of(
      app, "--standing", standing_, structures,
      "Instead of the flow, simulate bodies at rest on each other, with a solver with warm start");
  number(app, "--seconds", seconds_, 1, 1e6, "Simulated time for --standing, in seconds");
  std::vector<std::string> barriers = barrier_names();
  barriers.emplace_back(kAll);
  one_of(app, "--barrier", barrier_, barriers,
         "Instead of the flow, simulate fast bodies that hit thin barriers");
  add_threads_option(app, options_.threads);
  add_seed_option(app, options_.seed);
  add_rows_options(app);
}

/// Returns the selected name, or all names.
std::vector<std::string> selected(const std::string& name, const std::vector<std::string>& all) {
  return name == kAll ? all : std::vector<std::string>{name};
}

// Measures each structure twice: with the manifolds of all parts, and with one manifold per region.
void Simulate::measure_standing() {
  const std::vector<std::string> names = selected(standing_, standing_names());
  plan(2 * names.size());
  for (const std::string& name : names) {
    for (const bool reduced : {false, true}) {
      step(name, [&] { add_standing(results, {name, reduced, seconds_, options_.threads}); });
    }
  }
  print("standing");
}

void Simulate::measure_barriers() {
  const std::vector<std::string> names = selected(barrier_, barrier_names());
  plan(names.size());
  for (const std::string& name : names) {
    BarrierRowOptions options{.scene = name, .threads = options_.threads};
    if (steps_->count() != 0) options.steps = options_.steps;
    if (objects_->count() != 0) options.size = options_.objects;
    step(name, [&] { add_barrier(results, options); });
  }
  print("barriers");
}

void Simulate::measure_flow() {
  FlowRun run(flow_options(options_), options_.steps, options_.check);
  run_announced(run, options_.steps);
  std::cout << isa_name() << ", " << threads_text(options_.threads)
            << "; medians of the profiled steps in the second half\n";
  add_flow(results, options_, run);
  for (const char* table : {"phases", "flows", "flow_checks"}) print(table);
  if (!out_.empty()) {
    results.context() = machine_facts();
    write_page(out_, kResultsPage, results.document());
  }
  if (run.faults().total() != 0 || run.history().greatest_rise() >= kMaxRise) fail();
}

void Simulate::measure() {
  Arenas(options_.threads).run(options_.threads, [&] {
    if (!standing_.empty()) return measure_standing();
    return barrier_.empty() ? measure_flow() : measure_barriers();
  });
}

}  // namespace

void add_simulate(CLI::App& app) {
  command<Simulate>(
      app, "simulate",
      "Simulates granular flow, buildings of blocks, or fast bodies, and checks the contacts",
      "Without options, grains flow through a funnel of triangles. The command fails if contacts "
      "create energy, or if a check finds a missing, false or duplicate contact. With --standing, "
      "bodies are at rest on each other, and the command fails if one drifts. With --barrier, fast "
      "bodies hit a funnel or a spinning blade, or a cloth drops on a ball, and the command fails "
      "if anything tunnels.");
}

}  // namespace winnow::bench
