// The command `winnow cluster`: runs a recording or scene on several ranks, which are processes
// (MPI) or virtual ranks in this process, and prints times, traffic and a digest. The run itself is
// in measure/cluster_run.

#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/commands/run_json.h"
#include "bench/common/arena.h"
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

/// Names of the values of ContactLevel.
constexpr std::array<const char*, 4> kContactLevelNames{"pairs", "boolean", "distance", "manifold"};

struct ClusterCommand {
  Target target;
  std::uint32_t ranks = 2;
  std::uint32_t virtual_ranks = 0;  // 0: processes
  std::size_t frames = 0;           // see Target::frames
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
Json cluster_json(const ClusterRun& run, const std::string& scene, std::size_t objects,
                  bool is_virtual, const std::string& level) {
  Json json = run_json(run, scene, objects);
  const auto each = [&](auto ClusterStatistics::*member) {
    return list_of(run.statistics, [&](const ClusterStatistics& frame) { return frame.*member; });
  };
  json.update({{"ranks", run.ranks},
               {"virtual", is_virtual},
               {"level", level.empty() ? "boxes" : level},
               {"digest", list_of(run.digests, digits_of)},
               {"ghosts", each(&ClusterStatistics::ghosts)},
               {"sent_bytes", each(&ClusterStatistics::bytes)},
               {"messages", each(&ClusterStatistics::messages)},
               {"migrated", each(&ClusterStatistics::migrated)},
               {"imbalance", each(&ClusterStatistics::imbalance)},
               {"cuts", run.statistics.back().cuts}});
  return json;
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
  ClusterRun result;
  Arenas(threads).run(threads, [&] {
    result = run_cluster(*source, transport, {Target::frames(scene, frames), contact_level()},
                         execution_for(threads));
  });
  result.threads = threads;
  if (transport.first_hosted() != 0) return;
  print(result, source->name(), source->objects());
  write_json(
      json,
      Json::array({cluster_json(result, source->name(), source->objects(), is_virtual, level)}));
}

void ClusterCommand::print(const ClusterRun& run, const std::string& scene,
                           std::size_t objects) const {
  const ClusterStatistics& last = run.statistics.back();
  const double per_body = 1.0 / static_cast<double>(objects);
  std::cout << scene << ", " << grouped(objects) << " objects, " << run.frame_ms.size()
            << " frames, " << run.ranks << (virtual_ranks != 0 ? " virtual ranks, " : " ranks, ")
            << threads_text(threads) << ", " << isa_name() << '\n';
  Table table({"ranks", "first ms", "frame ms", "pairs", "ghosts", "sent bytes", "messages",
               "imbalance", "cuts", "bytes/object"});
  table.add({std::to_string(run.ranks), short_number(run.frame_ms.front()),
             short_number(run.frame_spread().median), grouped(last.pairs),
             percent(static_cast<double>(last.ghosts) * per_body), grouped(last.bytes),
             grouped(last.messages), short_number(last.imbalance), std::to_string(last.cuts),
             short_number(static_cast<double>(run.bytes) * per_body)});
  std::cout << table << "of the last frame; digest " << digits_of(run.digests.back()) << '\n';
}

}  // namespace

void add_cluster(CLI::App& app) {
  command<ClusterCommand>(app, "cluster",
                          "Finds all pairs in every frame of a recording or scene on many ranks",
                          "Ranks are processes started by mpirun, or virtual ranks in one process. "
                          "Times are the times of the slowest process.");
}

}  // namespace winnow::bench
