// The command `winnow simulate`: runs a granular flow, bodies that stand on each other, or fast
// bodies at barriers, on winnow's scene, and checks the results. The simulations are in
// bench/simulation, the rows in bench/rows.

#include <winnow/simd/isa.h>
#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/common/arena.h"
#include "bench/common/table.h"
#include "bench/pages/page.h"
#include "bench/recordings/recording.h"
#include "bench/rows/machine.h"
#include "bench/rows/rows.h"
#include "bench/simulation/mesh_files.h"

#include <algorithm>
#include <iostream>
#include <vector>

namespace winnow::bench {
namespace {

/// Steps per recorded frame, in which bodies move about a hundredth of their size.
constexpr std::size_t kRecorded = 10;
constexpr std::size_t kReports = 20;
/// A larger relative rise of the energy makes the command fail.
constexpr double kMaxRise = 1e-3;

/// Selects every structure or barrier.
constexpr const char* kAll = "all";

/// Runs steps and announces some of them.
class AnnouncedSteps {
 public:
  AnnouncedSteps(FlowRun& run, std::size_t steps)
      : run_(run),
        every_(std::max<std::size_t>(1, steps / kReports)),
        progress_(std::min(steps, kReports)) {}

  void step() {
    if (run_.flow().steps() % every_ == 0) announce();
    run_.step();
  }
  [[nodiscard]] const GranularFlow& flow() const { return run_.flow(); }

 private:
  void announce() {
    const std::vector<FlowSample>& samples = run_.history().samples();
    std::string text = "step " + grouped(run_.flow().steps());
    if (!samples.empty()) {
      text += ", " + grouped(samples.back().contacts) + " contacts, " +
              short_number(samples.back().times.total()) + " ms a step";
    }
    progress_.step(text);
  }

  FlowRun& run_;
  std::size_t every_;
  Progress progress_;
};

/// A flow as a FrameSource, for the writer of recordings.
class FlowFrames final : public FrameSource {
 public:
  explicit FlowFrames(AnnouncedSteps& steps) : steps_(steps), boxes_(steps.flow().objects()) {
    look();
  }

  [[nodiscard]] std::string name() const override { return "granular flow"; }
  [[nodiscard]] Aabb world() const override { return steps_.flow().world(); }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return boxes_; }
  bool advance() override {
    for (std::size_t i = 0; i < kRecorded; ++i) steps_.step();
    look();
    return true;
  }

 private:
  void look() {
    for (std::size_t i = 0; i < boxes_.size(); ++i) boxes_[i] = steps_.flow().box(i);
  }

  AnnouncedSteps& steps_;
  std::vector<Aabb> boxes_;
};

class Simulate final : public RowsCommand {
 public:
  void add_options(CLI::App& app);

 private:
  void measure() override;
  void measure_standing();
  void measure_barriers();

  FlowRowOptions options_{.objects = 10'000, .steps = 2'000, .threads = usual_threads().back()};
  std::string mesh_;
  std::string out_;
  std::string record_;
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
  option(app, "--mesh", mesh_,
         "OBJ, STL or PLY file of a mesh instead of the funnel, scaled to the funnel's width");
  option(app, "--out", out_, "HTML page to write, with plots over time");
  option(app, "--record", record_, ".aabbs file to write, with a frame every 10 steps");
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

// Measures each structure twice: with the manifolds of all parts, and with one manifold per region.
void Simulate::measure_standing() {
  std::vector<std::string> names{standing_};
  if (standing_ == kAll) names = standing_names();
  plan(2 * names.size());
  Arenas(options_.threads).run(options_.threads, [&] {
    for (const std::string& name : names) {
      for (const bool reduced : {false, true}) {
        step(name, [&] { add_standing(results, {name, reduced, seconds_, options_.threads}); });
      }
    }
  });
  print("standing");
}

void Simulate::measure_barriers() {
  std::vector<std::string> names{barrier_};
  if (barrier_ == kAll) names = barrier_names();
  plan(names.size());
  Arenas(options_.threads).run(options_.threads, [&] {
    for (const std::string& name : names) {
      BarrierRowOptions options{.scene = name, .threads = options_.threads};
      if (steps_->count() != 0) options.steps = options_.steps;
      if (objects_->count() != 0) options.size = options_.objects;
      step(name, [&] { add_barrier(results, options); });
    }
  });
  print("barriers");
}

void Simulate::measure() {
  if (!standing_.empty()) {
    measure_standing();
    return;
  }
  if (!barrier_.empty()) {
    measure_barriers();
    return;
  }
  FlowOptions options = flow_options(options_);
  if (!mesh_.empty()) {
    try {
      options.mesh = read_mesh(mesh_);
    } catch (const MeshFileError& error) {
      throw ArgumentError(std::string("--mesh: ") + error.what());
    }
  }
  Arenas(options_.threads).run(options_.threads, [&] {
    FlowRun run(options, options_.steps, options_.check);
    {
      AnnouncedSteps steps(run, options_.steps);
      if (record_.empty()) {
        for (std::size_t i = 0; i < options_.steps; ++i) steps.step();
      } else {
        FlowFrames frames(steps);
        write_recording(record_, frames, options_.shape,
                        std::max<std::size_t>(1, options_.steps / kRecorded));
      }
    }
    std::cout << isa_name() << ", " << threads_text(options_.threads)
              << "; medians of the profiled steps in the second half\n";
    options_.steps = run.flow().steps();
    add_flow(results, options_, run);
    for (const char* table : {"phases", "flows", "flow_checks"}) print(table);
    if (!out_.empty()) {
      results.context() = machine_facts();
      write_page(out_, kResultsPage, results.document());
    }
    if (run.faults().total() != 0 || run.history().greatest_rise() >= kMaxRise) fail();
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
