// Usage: winnow_soak [--frames N] [--seconds N] [--seed N] [--threads N] [--objects N]
// [--check-every N] [--lap N] [NAME...]
//
// Plays the given number of frames of objects that arrive, leave and move on each structure, and of
// bodies in a scene, compared with brute force. NAME is a structure or `scene`; the default is all.
// With --seconds, rounds with other seeds continue until the time has passed. With --lap, the
// objects repeat their motion after this number of frames. Prints a line for each NAME, then one
// line of JSON. Returns 1 if a result is wrong, a loaded snapshot continues differently, a
// footprint differs from the allocated memory, or memory grows.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

#include "tests/soak/soak.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

struct SoakOptions {
  SoakPlan plan{.frames = 1'000'000};
  std::uint64_t seconds = 0;
  std::vector<std::string> names;
};

/// Returns false for an invalid number or an unknown option.
bool read_option(SoakOptions& options, std::string_view name, std::string_view value) {
  std::uint64_t number = 0;
  const auto read = std::from_chars(value.data(), value.data() + value.size(), number);
  if (read.ec != std::errc() || read.ptr != value.data() + value.size()) return false;
  if (name == "--frames")
    options.plan.frames = number;
  else if (name == "--seconds")
    options.seconds = number;
  else if (name == "--seed")
    options.plan.seed = number;
  else if (name == "--threads")
    options.plan.threads = static_cast<int>(number);
  else if (name == "--objects")
    options.plan.objects = number;
  else if (name == "--lap")
    options.plan.lap = number;
  else if (name == "--check-every")
    options.plan.check_every = number;
  else
    return false;
  return number != 0;
}

bool is_there(std::string_view name) {
  const auto all = all_structures();
  return name == "scene" || std::any_of(all.begin(), all.end(), [&](const StructureKind& one) {
           return one.name() == name;
         });
}

bool read_arguments(SoakOptions& options, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word.starts_with("--")) {
      if (++i == argc || !read_option(options, word, argv[i])) return false;
    } else if (is_there(word)) {
      options.names.emplace_back(word);
    } else {
      return false;
    }
  }
  if (!options.names.empty()) return true;
  for (const StructureKind& one : all_structures()) options.names.emplace_back(one.name());
  options.names.emplace_back("scene");
  return true;
}

/// Returns true if the peak of memory in the second half of the run is at most 10% above the first
/// half's, or if the run is too short to reach its peak.
bool is_flat(const SoakTally& tally) {
  constexpr std::uint64_t kLong = 100'000;
  return tally.frames < kLong ||
         static_cast<double>(tally.last_peak) <= 1.1 * static_cast<double>(tally.first_peak);
}

void print(const SoakTally& t) {
  std::printf(
      "%-18s %9llu %12llu %14llu %8llu %6llu %9zu %9zu %9llu %8.2f %8.2f %6.1f\n", t.name.c_str(),
      static_cast<unsigned long long>(t.frames), static_cast<unsigned long long>(t.operations),
      static_cast<unsigned long long>(t.comparisons), static_cast<unsigned long long>(t.checks),
      static_cast<unsigned long long>(t.snapshots), t.first_peak, t.last_peak,
      static_cast<unsigned long long>(t.frames_without_requests), t.median_us, t.p999_us,
      t.median_us > 0.0 ? t.p999_us / t.median_us : 0.0);
  std::fflush(stdout);
}

SoakTally soak(const std::string& name, const SoakPlan& plan) {
  return name == "scene" ? soak_scene(plan) : soak_partition(structure_named(name), plan);
}

/// Prints the sums of all runs, in one line.
void print_json(const std::vector<SoakTally>& tallies) {
  SoakTally sum;
  std::uint64_t without = ~std::uint64_t{0};
  double worst = 0.0;
  for (const SoakTally& t : tallies) {
    sum.frames += t.frames;
    sum.operations += t.operations;
    sum.comparisons += t.comparisons;
    sum.checks += t.checks;
    sum.snapshots += t.snapshots;
    without = std::min(without, t.frames_without_requests);
    if (t.median_us > 0.0) worst = std::max(worst, t.p999_us / t.median_us);
  }
  std::printf(
      "{\"runs\": %zu, \"frames\": %llu, \"operations\": %llu, \"comparisons\": %llu, "
      "\"checks\": %llu, \"snapshots\": %llu, \"frames_without_requests\": %llu, "
      "\"worst_p999_over_median\": %.1f}\n",
      tallies.size(), static_cast<unsigned long long>(sum.frames),
      static_cast<unsigned long long>(sum.operations),
      static_cast<unsigned long long>(sum.comparisons), static_cast<unsigned long long>(sum.checks),
      static_cast<unsigned long long>(sum.snapshots), static_cast<unsigned long long>(without),
      worst);
}

using Clock = std::chrono::steady_clock;

int run(SoakOptions options) {
  std::printf("%-18s %9s %12s %14s %8s %6s %9s %9s %9s %8s %8s %6s\n", "", "frames", "operations",
              "comparisons", "checks", "saved", "peak B", "later B", "quiet", "us", "p99.9",
              "ratio");
  const auto start = Clock::now();
  std::vector<SoakTally> tallies;
  do {
    for (const std::string& name : options.names) {
      try {
        tallies.push_back(soak(name, options.plan));
      } catch (const std::runtime_error& error) {
        std::fprintf(stderr, "%s, seed %llu: %s\n", name.c_str(),
                     static_cast<unsigned long long>(options.plan.seed), error.what());
        return 1;
      }
      print(tallies.back());
      if (!is_flat(tallies.back())) {
        std::fprintf(stderr, "%s: memory grows\n", name.c_str());
        return 1;
      }
    }
    ++options.plan.seed;
  } while (Clock::now() - start < std::chrono::seconds(options.seconds));
  print_json(tallies);
  return 0;
}

}  // namespace
}  // namespace winnow::test

int main(int argc, char** argv) {
  winnow::test::SoakOptions options;
  options.plan.seed = winnow::test::base_seed();
  if (!winnow::test::read_arguments(options, argc, argv)) {
    std::fprintf(stderr,
                 "usage: winnow_soak [--frames N] [--seconds N] [--seed N] [--threads N] "
                 "[--check-every N] [STRUCTURE|scene]...\n");
    return 2;
  }
  return winnow::test::run(std::move(options));
}
