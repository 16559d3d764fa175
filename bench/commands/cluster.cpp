// The command `winnow cluster`: runs a recording or scene on several ranks, which are processes
// (MPI) or virtual ranks in this process, and prints times, traffic and a digest. The run itself is
// in measure/cluster_run.

#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/arena.h"
#include "bench/common/json.h"
#include "bench/common/sample.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/cluster_run.h"
#include "bench/measure/mpi_session.h"

#include <unistd.h>
#include <winnow/simd/isa.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>

namespace winnow::bench {
namespace {

constexpr std::size_t kClusterFrames = 30;
/// Names of the values of ContactLevel.
constexpr std::array<const char*, 4> kContactLevelNames{"pairs", "boolean", "distance", "manifold"};

struct ClusterCommand {
  Target target;
  std::uint32_t ranks = 2;
  std::uint32_t virtual_ranks = 0;  // 0: processes
  std::size_t frames = 0;           // 0: all of a recording, kClusterFrames of a scene
  std::string level;                // empty: pairs of boxes only
  std::string json;
  std::string isa;
  int threads = 1;
  double time_limit = 60.0;

  void add_options(CLI::App& app) {
    target.add_to(app);
    number(app, "--ranks", ranks, 1, 4096,
           "Number of processes; if mpirun started this one, its number of processes");
    number(app, "--virtual-ranks", virtual_ranks, 0, 65536,
           "Number of virtual ranks in this process, instead of processes");
    one_of(app, "--level", level, {kContactLevelNames.begin(), kContactLevelNames.end()},
           "Find contacts of bodies at this level, instead of pairs of boxes; each body is as "
           "large as its box");
    add_threads_option(app, threads, "Number of threads of each process");
    add_isa_option(app, isa);
    add_frames_option(app, frames);
    number(app, "--time-limit", time_limit, 0.1, 1e6, "Time limit for other processes, in seconds");
    add_json_option(app, json);
  }
  int run();

 private:
  [[nodiscard]] std::optional<ContactLevel> contact_level() const;
  [[noreturn]] void start_ranks() const;
  void run_over(Transport& transport, bool is_virtual) const;
  void run_over_mpi() const;
  void print(const ClusterRun& run, const std::string& scene, std::size_t objects) const;
};

std::string digits_of(const ClusterDigest& digest) {
  return to_hex(digest.high) + to_hex(digest.low);
}

/// Returns the members that `replay` writes for a run, and the traffic and balance of the ranks.
Json cluster_json(const ClusterRun& run, const std::string& scene, std::size_t objects, int threads,
                  bool is_virtual, const std::string& level) {
  using Frame = const ClusterFrame&;
  const auto ms = run.each([](Frame frame) { return frame.frame_ms; });
  const Spread spread = spread_of(std::span(ms).subspan(ms.size() > 1 ? 1 : 0));
  return {{"scene", scene},
          {"objects", objects},
          {"frames", run.frames.size()},
          {"partition", "LinearBvh"},
          {"ranks", run.ranks},
          {"virtual", is_virtual},
          {"level", level.empty() ? "boxes" : level},
          {"threads", threads},
          {"isa", isa_name()},
          {"build_ms", ms.front()},
          {"min_ms", spread.min},
          {"median_ms", spread.median},
          {"max_ms", spread.max},
          {"frame_ms", ms},
          {"update_ms", run.each([](Frame frame) { return frame.update_ms; })},
          {"pairs", run.each([](Frame frame) { return frame.pairs.pairs; })},
          {"reported", run.each([](Frame frame) { return frame.pairs.reported; })},
          {"fingerprint", run.each([](Frame frame) { return to_hex(frame.pairs.fingerprint); })},
          {"digest", run.each([](Frame frame) { return digits_of(frame.digest); })},
          {"ghosts", run.each([](Frame frame) { return frame.statistics.ghosts; })},
          {"sent_bytes", run.each([](Frame frame) { return frame.statistics.bytes; })},
          {"messages", run.each([](Frame frame) { return frame.statistics.messages; })},
          {"migrated", run.each([](Frame frame) { return frame.statistics.migrated; })},
          {"imbalance", run.each([](Frame frame) { return frame.statistics.imbalance; })},
          {"cuts", run.frames.back().statistics.cuts},
          {"bytes", run.bytes},
          {"bytes_per_object", static_cast<double>(run.bytes) / static_cast<double>(objects)}};
}

std::optional<ContactLevel> ClusterCommand::contact_level() const {
  const auto* const at = std::find(kContactLevelNames.begin(), kContactLevelNames.end(), level);
  if (at == kContactLevelNames.end()) return {};
  return static_cast<ContactLevel>(at - kContactLevelNames.begin());
}

int ClusterCommand::run() {
  choose_isa(isa);
  if (virtual_ranks != 0) {
    LoopbackTransport transport(virtual_ranks);
    run_over(transport, true);
    return kDone;
  }
  if (!MpiSession::is_available()) {
    throw ArgumentError(
        "--ranks needs MPI and Zoltan, but this tool was built without them (Debian: "
        "libopenmpi-dev, libtrilinos-zoltan-dev); --virtual-ranks needs neither");
  }
  if (!MpiSession::is_started()) start_ranks();
  run_over_mpi();
  return kDone;
}

void ClusterCommand::run_over_mpi() const {
  MpiSession session(time_limit);
  try {
    run_over(session.transport(), false);
  } catch (const std::exception& error) {
    // The other ranks wait for this one and cannot be notified, so abort them as well.
    std::cerr << "winnow: " << error.what() << '\n';
    MpiSession::abort();
  }
}

/// Replaces this process by mpirun, which starts this command in `ranks` processes.
void ClusterCommand::start_ranks() const {
  std::vector<std::string> words{"mpirun", "--oversubscribe", "-n", std::to_string(ranks),
                                 std::filesystem::read_symlink("/proc/self/exe").string()};
  if (geteuid() == 0) words.insert(words.begin() + 1, "--allow-run-as-root");
  std::ifstream own("/proc/self/cmdline");
  std::string word;
  std::getline(own, word, '\0');  // the name of this program
  while (std::getline(own, word, '\0')) words.push_back(word);
  std::cout.flush();
  become(words);
  throw ArgumentError("mpirun cannot be started (Debian: openmpi-bin)");
}

void ClusterCommand::run_over(Transport& transport, bool is_virtual) const {
  const NamedScene scene = target.named();
  const auto source = target.source(scene);
  const std::size_t frame_count = frames != 0            ? frames
                                  : scene.is_recording() ? scene.recording->frames.size()
                                                         : kClusterFrames;
  ClusterRun result;
  Arenas(threads).run(threads, [&] {
    result =
        run_cluster(*source, transport, {frame_count, contact_level()}, execution_for(threads));
  });
  if (transport.first_hosted() != 0) return;
  print(result, source->name(), source->objects());
  write_json(json, Json::array({cluster_json(result, source->name(), source->objects(), threads,
                                             is_virtual, level)}));
}

void ClusterCommand::print(const ClusterRun& run, const std::string& scene,
                           std::size_t objects) const {
  const ClusterFrame& last = run.frames.back();
  const double per_body = 1.0 / static_cast<double>(objects);
  std::cout << scene << ", " << grouped(objects) << " objects, " << run.frames.size() << " frames, "
            << run.ranks << (virtual_ranks != 0 ? " virtual ranks, " : " ranks, ")
            << threads_text(threads) << ", " << isa_name() << '\n';
  Table table({"ranks", "first ms", "frame ms", "pairs", "ghosts", "sent bytes", "messages",
               "imbalance", "cuts", "bytes/object"});
  table.add({std::to_string(run.ranks), short_number(run.frames.front().frame_ms),
             short_number(run.median_ms()), grouped(last.pairs.pairs),
             percent(static_cast<double>(last.statistics.ghosts) * per_body),
             grouped(last.statistics.bytes), grouped(last.statistics.messages),
             short_number(last.statistics.imbalance), std::to_string(last.statistics.cuts),
             short_number(static_cast<double>(run.bytes) * per_body)});
  std::cout << table << "of the last frame; digest " << digits_of(last.digest) << '\n';
}

}  // namespace

void add_cluster(CLI::App& app) {
  command<ClusterCommand>(app, "cluster",
                          "Finds all pairs in every frame of a recording or scene on many ranks",
                          "Ranks are processes started by mpirun, or virtual ranks in one process. "
                          "Times are the times of the slowest process.");
}

}  // namespace winnow::bench
