#pragma once

// Measurements. Each function measures something and adds its rows to the results; families.json
// lists the families of rows. A function that finds a wrong result adds its rows first and throws
// std::runtime_error then.

#include "bench/measure/advice.h"
#include "bench/measure/race.h"
#include "bench/measure/scene_race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"
#include "bench/simulation/flow_run.h"
#include "bench/simulation/standing.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

// Frames of partitions and of other libraries. All contenders of a race must find the same pairs.
// The functions write the scene's name and recording to the options.

/// A row's fingerprint covers this many frames, so that engines that ran fewer frames than others
/// can be compared.
inline constexpr std::size_t kFingerprintFrames = 3;
/// The scenes whose first frames are measured.
inline const std::vector<std::string> kColdScenes{"uniform", "mixed", "clustered"};

/// Adds a row of `throughput` for each run, with `only_peers` only for runs of other libraries.
Measurement add_frame_race(Results& results, const NamedScene& scene, MeasureOptions options,
                           bool only_peers = false);
/// Adds rows about the partitions that were left out of a race.
void note_skipped(Results& results, std::size_t objects, const std::vector<std::string>& skipped,
                  bool peers);
/// Adds the rows derived from one scene and size: speedups of wider instruction sets and of more
/// threads, and the growth of the time with size.
void derive_frames(Results& results, const std::string& scene, std::size_t objects);
/// Adds the row of the fastest partition on one thread among the rows of `throughput` of the active
/// instruction set; adds nothing if there are no such rows.
void add_limit(Results& results, const std::string& scene, std::size_t objects);
/// Adds the frames of all partitions without a size limit.
void add_every_scene(Results& results, const NamedScene& scene, MeasureOptions options);

// The functions below, except add_throughput, measure only on the first number of threads; 0 frames
// are a default of each, and `frames` are rounds of add_cold.

/// Returns the command that measures a partition again.
[[nodiscard]] std::string partition_command(const std::string& command, const NamedScene& scene,
                                            const MeasureOptions& options,
                                            const std::string& partition);
/// Adds a race and the rows derived from it.
void add_throughput(Results& results, const NamedScene& scene, const MeasureOptions& options);
/// Adds first frames.
void add_cold(Results& results, const NamedScene& scene, const MeasureOptions& options);
/// Adds frames whose tasks run on a plain pool of threads and on oneTBB.
void add_hosts(Results& results, const NamedScene& scene, const MeasureOptions& options);

// Memory.

/// Adds the memory that each partition has allocated, which must equal its footprint. The rows by
/// resident set are correct only if keep_resident_set_exact was called before.
void add_footprints(Results& results, const NamedScene& scene, const MeasureOptions& options);
/// As above, in a separate process, whose memory nothing else changes.
void add_footprints_apart(Results& results, const NamedScene& scene, const MeasureOptions& options);

// The choice of a partition.

Advice add_advice(Results& results, const NamedScene& scene, std::size_t objects,
                  std::uint64_t seed, const std::vector<std::string>& partitions,
                  std::size_t frames, int threads);
/// Adds the sum of AutoPartition's first frames, and of those of the best partition.
void add_first_frames(Results& results, const NamedScene& scene, std::size_t objects, int threads);
/// Adds how many frames AutoPartition loses in the frames after a scene turns into another one.
void add_changes(Results& results, std::size_t objects, std::size_t frames_each);
/// Adds the worst of many frames over the median one (`ratio`), and over the median of the frames
/// around it (`hitch`), of frames in which something moves, after settling.
void add_worst_frames(Results& results, const NamedScene& scene, std::size_t objects,
                      std::size_t frames);

// Pairs of shapes.

/// Adds the results of winnow's tiers, each with its guaranteed error, and of other libraries, with
/// an allowed error of 1e-4 of the size, for the cases of a family. Other libraries get no
/// roundings, rays or bad input. libccd starts from the shapes' origins and therefore gets only
/// shapes that contain their origin. An exception counts as a wrong answer. Throws ArgumentError if
/// a question is not a hard case.
void add_hard_cases(Results& results, const std::string& family, const Json& questions, bool peers);
/// Adds the sums of the rows added so far.
void add_hard_case_totals(Results& results);

// Whole scenes.

struct PipelineMeasureOptions {
  std::string scene = "pile";  ///< pile, terrain or balls
  bool resting = false;        ///< bodies rest, and winnow caches contacts
  std::vector<int> threads{1, 2};
  bool peers = true;
  std::size_t frames = 9;
  const BodySet* set = nullptr;  ///< the scene's bodies; add_scene_costs makes its own
  std::size_t bodies = 0;        ///< number of bodies; 0: the scene's default
  std::uint64_t seed = 1;
};

/// Runs a race on a scene of the whole pipeline, up to contact points.
void add_scene_race(Results& results, const PipelineMeasureOptions& options);
/// Measures only winnow, up to a level.
void add_scene_level(Results& results, const PipelineMeasureOptions& options,
                     const std::string& level);
/// Measures only winnow, on the first number of threads, with bodies that move a little: bytes of
/// contacts, and the cost of a contact margin.
void add_scene_costs(Results& results, const PipelineMeasureOptions& options);
/// Returns "pairs", "boolean", "distance", "manifold".
[[nodiscard]] std::vector<std::string> scene_level_names();

// Simulations.

struct FlowRowOptions {
  std::string shape = "mixed";  ///< see flow_shape_names()
  std::size_t objects = 500;
  std::size_t steps = 3000;
  std::uint64_t seed = 1;
  int threads = 1;
  std::size_t check = 0;  ///< see FlowRun
};
[[nodiscard]] std::vector<std::string> flow_shape_names();
[[nodiscard]] FlowOptions flow_options(const FlowRowOptions& row_options);
/// Adds the rows of a flow that has run.
void add_flow(Results& results, const FlowRowOptions& row_options, const FlowRun& run);
/// Runs a flow and adds its rows.
void add_flow(Results& results, const FlowRowOptions& row_options);

/// Runs a flow, and adds the time of further frames beside the sum of what they consist of,
/// measured on its own: boxes and pairs of a partition, and contacts of these pairs by the narrow
/// phase.
void add_flow_frames(Results& results, const FlowRowOptions& row_options, std::size_t frames);

struct StandingRowOptions {
  std::string structure = "stack";  ///< see standing_names()
  bool reduced = false;
  double seconds = 60.0;
  int threads = 1;
};
/// Simulates one structure, which must not move.
void add_standing(Results& results, const StandingRowOptions& row_options);

/// A simulation of fast motion in which nothing may tunnel through anything.
struct BarrierRowOptions {
  std::string scene = "funnel";  ///< see barrier_names()
  std::size_t steps = 200;
  /// Number of bodies, or of vertices along an edge of the cloth; 0 chooses a size that suits the
  /// scene.
  std::size_t size = 0;
  int threads = 1;
};
[[nodiscard]] std::vector<std::string> barrier_names();
/// Runs one simulation, in which nothing may tunnel.
void add_barrier(Results& results, const BarrierRowOptions& row_options);

// Many processes.

/// A scene on virtual ranks within this process. The number of objects of each rank and the number
/// of bytes sent are the same as with one process for each rank.
struct ClusterRowOptions {
  NamedScene scene;
  std::size_t objects = 20'000;
  std::size_t frames = 6;
  std::vector<std::uint32_t> ranks;  ///< ascending; the first is 1, the reference
  std::uint64_t seed = 1;
};
/// All numbers of ranks must find the pairs of one rank.
void add_cluster_runs(Results& results, const ClusterRowOptions& options);

}  // namespace winnow::bench
