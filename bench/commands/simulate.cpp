#include "bench/commands/arguments.h"
#include "bench/commands/command.h"
#include "bench/common/arena.h"
#include "bench/common/counting_resource.h"
#include "bench/common/json.h"
#include "bench/common/progress.h"
#include "bench/common/table.h"
#include "bench/measure/fingerprint.h"
#include "bench/recordings/recording.h"
#include "bench/report/page.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/print.h"
#include "bench/simulation/flow_check.h"
#include "bench/simulation/flow_history.h"
#include "bench/simulation/mesh_files.h"

#include <algorithm>
#include <iostream>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

/// Steps from one recorded frame to the next: bodies move about a hundredth of their size.
constexpr std::size_t kRecorded = 10;
constexpr std::size_t kReports = 20;
/// Rises of the energy that are taken for errors of the integration.
constexpr double kMostRise = 1e-3;

/// Facts about a run, as they are printed: what and how much.
using FlowFacts = std::vector<std::pair<std::string, std::string>>;

/// A flow, step by step, with everything that is noted of it.
class FlowRun {
 public:
  FlowRun(const FlowOptions& options, std::size_t steps, std::size_t check)
      : flow_(with_memory(options)),
        steps_(steps),
        check_(check),
        progress_(std::min(steps, kReports)) {
    if (check_ != 0) flow_.keep_contact_poses();
  }

  void step() {
    const std::size_t i = flow_.steps();
    const std::size_t every = std::max<std::size_t>(1, steps_ / kReports);
    if (i % every == 0) announce();
    if (i == warm_up()) {
      allocations_before_ = memory_.allocations();
      steady_before_ = steady_.count();
    }
    flow_.step(i % kProfiledSteps == 0);
    history_.add(flow_);
    steady_.note(flow_, memory_.allocations());
    if (check_ != 0 && i % check_ == 0) {
      faults_ += check_contacts(flow_);
      ++checks_;
    }
  }

  [[nodiscard]] std::size_t warm_up() const { return steps_ / 2; }
  [[nodiscard]] std::size_t allocations() const {
    return memory_.allocations() - allocations_before_;
  }
  /// In steps with no more contacts than before.
  [[nodiscard]] std::size_t steady_allocations() const { return steady_.count() - steady_before_; }
  [[nodiscard]] std::size_t bytes() const { return memory_.outstanding(); }
  [[nodiscard]] const GranularFlow& flow() const { return flow_; }
  [[nodiscard]] const FlowHistory& history() const { return history_; }
  [[nodiscard]] const FlowFaults& faults() const { return faults_; }
  [[nodiscard]] std::size_t checks() const { return checks_; }
  void finish() { progress_.clear(); }

 private:
  FlowOptions with_memory(FlowOptions options) {
    options.memory = &memory_;
    return options;
  }

  void announce() {
    const std::vector<FlowSample>& samples = history_.samples();
    std::string text = "step " + grouped(flow_.steps());
    if (!samples.empty()) {
      text += ", " + grouped(samples.back().contacts) + " contacts, " +
              short_number(samples.back().times.total()) + " ms a step";
    }
    progress_.step(text);
  }

  CountingResource memory_;
  GranularFlow flow_;
  FlowHistory history_;
  std::size_t steps_;
  std::size_t check_;
  FlowFaults faults_;
  std::size_t checks_ = 0;
  SteadyAllocations steady_;
  std::size_t allocations_before_ = 0;
  std::size_t steady_before_ = 0;
  Progress progress_;
};

/// A flow as the writer of recordings wants it.
class FlowFrames final : public FrameSource {
 public:
  explicit FlowFrames(FlowRun& run) : run_(run), boxes_(run.flow().objects()) { look(); }

  [[nodiscard]] std::string name() const override { return "granular flow"; }
  [[nodiscard]] Aabb world() const override { return run_.flow().world(); }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return boxes_; }
  bool advance() override {
    for (std::size_t i = 0; i < kRecorded; ++i) run_.step();
    look();
    return true;
  }

 private:
  void look() {
    for (std::size_t i = 0; i < boxes_.size(); ++i) boxes_[i] = run_.flow().box(i);
  }

  FlowRun& run_;
  std::vector<Aabb> boxes_;
};

struct Simulate {
  Choice choice;
  std::size_t objects = 10'000;
  std::size_t steps = 2'000;
  std::string shape = "mixed";
  int threads = usual_threads().back();
  std::size_t check = 0;
  std::string mesh;
  std::string out;
  std::string record;
  std::string json;

  int run();

 private:
  [[nodiscard]] FlowFacts facts(const FlowRun& run) const;
  [[nodiscard]] Results rows(const FlowRun& run) const;
  void write_flow_page(const Results& results, const FlowFacts& facts) const;
};

FlowFacts Simulate::facts(const FlowRun& run) const {
  const GranularFlow& flow = run.flow();
  const FlowSample& last = run.history().samples().back();
  FlowFacts facts{
      {"objects", grouped(flow.objects()) + " " + shape},
      {"mesh",
       (mesh.empty() ? "funnel" : mesh) + ", " + grouped(flow.mesh().size()) + " triangles"},
      {"steps", grouped(flow.steps()) + ", " + short_number(flow.time()) + " s"},
      {"put back at the top", grouped(flow.returned())},
      {"contacts in the last step",
       grouped(last.contacts) + " pairs, " + grouped(last.points) + " points"},
      {"energy in the last step", short_number(last.energy.kinetic) + " kinetic, " +
                                      short_number(last.energy.potential) + " potential, " +
                                      short_number(last.energy.elastic) + " in contacts"},
      {"greatest rise of the energy",
       short_number(100.0 * run.history().greatest_rise()) + " % of the greatest kinetic energy"},
      {"greatest penetration", short_number(run.history().deepest())},
      {"bytes", grouped(run.bytes())},
      {"allocations after " + grouped(run.warm_up()) + " steps",
       grouped(run.allocations()) + ", " + grouped(run.steady_allocations()) +
           " in steps with no more contacts than ever before"}};
  if (check != 0) {
    const FlowFaults& faults = run.faults();
    facts.emplace_back("checked by brute force",
                       grouped(run.checks()) + " steps, " + grouped(faults.compared) +
                           " contacts: " + grouped(faults.lost) + " lost, " +
                           grouped(faults.invented) + " invented, " + grouped(faults.doubled) +
                           " doubled");
  }
  facts.emplace_back("fingerprint", to_hex(flow.fingerprint()));
  return facts;
}

/// Rows of the report, and how the memory and the check went.
Results Simulate::rows(const FlowRun& run) const {
  Results results;
  declare_flows(results);
  results.declare({"flow_checks",
                   "pipeline",
                   "memory and contacts of a granular flow",
                   {"shape", "objects", "steps"},
                   {{"allocations", "allocations in the second half", ""},
                    {"steady_allocations", "with no more contacts than ever before", ""},
                    {"lost", "contacts lost", "", Better::less, Format::count},
                    {"invented", "contacts invented", "", Better::less, Format::count},
                    {"doubled", "contacts doubled", "", Better::less, Format::count}}});
  add_flow(results,
           {.shape = shape,
            .objects = objects,
            .steps = run.flow().steps(),
            .seed = choice.seed,
            .threads = threads},
           run.flow(), run.history());
  results.add("flow_checks", {{"shape", shape},
                              {"objects", objects},
                              {"steps", run.flow().steps()},
                              {"allocations", run.allocations()},
                              {"steady_allocations", run.steady_allocations()},
                              {"lost", run.faults().lost},
                              {"invented", run.faults().invented},
                              {"doubled", run.faults().doubled}});
  return results;
}

void Simulate::write_flow_page(const Results& results, const FlowFacts& facts) const {
  const PageParts page = section_parts(results, section_of("pipeline"));
  Json shown_facts = Json::object();
  for (const auto& [what, much] : facts) shown_facts[what] = much;
  write_plot_page(out, "winnow simulate",
                  "<h1>Granular flow</h1>\n" + facts_table("run", shown_facts) + page.html,
                  page.plots);
}

int Simulate::run() {
  choose_isa(choice.isa);
  FlowOptions options;
  options.objects = objects;
  options.shape = flow_shape_named(shape);
  options.seed = choice.seed;
  options.execution = threads == 1 ? Execution::serial() : Execution::parallel();
  if (!mesh.empty()) {
    try {
      options.mesh = read_mesh(mesh);
    } catch (const MeshFileError& error) {
      throw ArgumentError(std::string("--mesh: ") + error.what());
    }
  }
  Arenas arenas(threads);
  int status = kDone;
  arenas.run(threads, [&] {
    FlowRun run(options, steps, check);
    if (record.empty()) {
      for (std::size_t i = 0; i < steps; ++i) run.step();
    } else {
      FlowFrames frames(run);
      write_recording(record, frames, shape, std::max<std::size_t>(1, steps / kRecorded));
    }
    run.finish();
    std::cout << isa_name() << ", " << threads_text(threads)
              << "; medians of the profiled steps in the second half\n";
    const Results measured = rows(run);
    print_rows(std::cout, measured, "phases");
    const FlowFacts all = facts(run);
    for (const auto& [what, much] : all) std::cout << what << ": " << much << '\n';
    if (!out.empty()) write_flow_page(measured, all);
    if (!json.empty()) write_json(json, all_rows_of(measured));
    const bool is_right = run.faults().total() == 0 && run.history().greatest_rise() < kMostRise;
    status = is_right ? kDone : kFailed;
  });
  return status;
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto simulate = std::make_shared<Simulate>();
  CLI::App* sub = app.add_subcommand(
      "simulate",
      "Granular flow through a funnel made of triangles: a simulation that embeds winnow, its soak "
      "test, and its benchmark from end to end. Fails if contacts create energy or a check finds a "
      "contact lost, invented or doubled.");
  sub->add_option("--objects", simulate->objects, "Number of bodies")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}))
      ->capture_default_str();
  sub->add_option("--steps", simulate->steps, "Steps of a thousandth of a second")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  sub->add_option("--shape", simulate->shape, "What falls")
      ->check(CLI::IsMember(flow_shape_names()))
      ->capture_default_str();
  sub->add_option("--mesh", simulate->mesh,
                  "An OBJ, STL or PLY file to fall into, scaled to the funnel's width");
  sub->add_option("--out", simulate->out, "An HTML page to write, with plots over time");
  sub->add_option("--record", simulate->record,
                  "An .aabbs file to write, one frame every 10 steps");
  sub->add_option("--check", simulate->check,
                  "Every so many steps, compare the contacts with those of all pairs");
  sub->add_option("--threads", simulate->threads, "Number of threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_isa_option(*sub, simulate->choice);
  add_seed_option(*sub, simulate->choice);
  add_json_option(*sub, simulate->json);
  return {sub, [simulate] { return simulate->run(); }};
}

}  // namespace winnow::bench
