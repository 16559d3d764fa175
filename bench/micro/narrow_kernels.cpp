#include "bench/micro/suite.h"
#include "bench/scenes/pair_set.h"
#include "pipeline/kernels/kernels.h"
#include "pipeline/solver/solver.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// As many pairs as NarrowPhase hands to a kernel at once.
constexpr std::uint32_t kPairs = kJobPairs;
constexpr std::size_t kContacts = std::size_t{kPairs} * kManifoldPoints + kContactSlack;

/// Pairs of one kind and room for all that a kernel writes about them.
class NarrowFixture {
 public:
  explicit NarrowFixture(const PairKind& kind)
      : set_(make_pair_set(kind, {.pairs = kPairs})),
        bytes_(kPairs + 64),
        doubles_(8, std::vector<double>(kPairs + 64)),
        words_(3, std::vector<std::uint32_t>(kPairs + 64)),
        floats_(4, std::vector<float>(kContacts)),
        features_(kContacts) {}

  [[nodiscard]] NarrowJob job() {
    NarrowJob job{};
    job.pairs = set_->pairs.data();
    job.count = kPairs;
    job.shapes = set_->shapes.data();
    job.poses = set_->poses.data();
    job.tables = set_->pool.tables();
    job.overlap = bytes_.data();
    job.distance = doubles_[0].data();
    job.error_bound = doubles_[1].data();
    job.contact_first = words_[0].data();
    job.contact_count = words_[1].data();
    job.uncertified = words_[2].data();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      job.normal[axis] = doubles_[2 + axis].data();
      job.point[axis] = doubles_[5 + axis].data();
      job.contacts.position[axis] = floats_[axis].data();
    }
    job.contacts.depth = floats_[3].data();
    job.contacts.feature = features_.data();
    return job;
  }

 private:
  std::unique_ptr<PairSet> set_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::vector<double>> doubles_;
  std::vector<std::vector<std::uint32_t>> words_;
  std::vector<std::vector<float>> floats_;
  std::vector<std::uint64_t> features_;
};

/// Made when the first benchmark of its kind runs.
using LazyFixture = std::shared_ptr<std::unique_ptr<NarrowFixture>>;

std::string name_of(const PairKind& kind, NarrowTier tier, ContactLevel level) {
  return "pairs: " + std::string(kind.name) + ", " + std::string(to_text(level)) + ", " +
         std::string(to_text(tier));
}

NarrowFixture& made(const LazyFixture& fixture, const PairKind& kind) {
  if (*fixture == nullptr) *fixture = std::make_unique<NarrowFixture>(kind);
  return **fixture;
}

NarrowKernel kernel_of(const PairKind& kind, NarrowTier tier, ContactLevel level) {
  const NarrowKernels* kernels = narrow_kernels(kind.a, kind.b);
  if (kernels == nullptr) return nullptr;
  const std::uint32_t at = kernel_index(level);
  return tier == NarrowTier::fast ? kernels->fast[at] : kernels->robust[at];
}

void add_kernel(const PairKind& kind, NarrowTier tier, ContactLevel level,
                const LazyFixture& fixture) {
  if (kernel_of(kind, tier, level) == nullptr) return;
  add_per_isa(name_of(kind, tier, level), [=](benchmark::State& state) {
    NarrowFixture& pairs = made(fixture, kind);
    const NarrowKernel kernel = kernel_of(kind, tier, level);
    std::uint32_t uncertified = 0;
    for (auto _ : state) {
      NarrowJob job = pairs.job();
      uncertified = kernel(job);
      benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * kPairs);
    state.counters["uncertified"] = uncertified;
  });
}

// The same on every instruction set.
void add_solver(const PairKind& kind, ContactLevel level, const LazyFixture& fixture) {
  const std::string name = name_of(kind, NarrowTier::reference, level) + "/any";
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    const NarrowJob job = made(fixture, kind).job();
    SolverCounts counts;
    for (auto _ : state) {
      for (const auto& [a, b] : std::span(job.pairs, job.count)) {
        benchmark::DoNotOptimize(solve_pair(job.tables, job.shapes[a], job.poses[a], job.shapes[b],
                                            job.poses[b], level, job.margin, counts));
      }
    }
    state.SetItemsProcessed(state.iterations() * kPairs);
  })->UseRealTime();
}

}  // namespace

void add_narrow_kernels() {
  for (const PairKind& kind : pair_kinds()) {
    const auto fixture = std::make_shared<std::unique_ptr<NarrowFixture>>();
    for (const ContactLevel level : kLevels) {
      add_kernel(kind, NarrowTier::fast, level, fixture);
      add_kernel(kind, NarrowTier::robust, level, fixture);
      add_solver(kind, level, fixture);
    }
  }
}

}  // namespace winnow::bench
