#pragma once

#include "goals/measures.h"

#include <string>
#include <vector>

namespace winnow::bench {

// One function a kind of ask; the topic is filled in by the caller. Times are compared with those
// of other libraries on another machine, scaled by the reference sweep.

// speed_kinds.cpp

/// The fastest partition of a cell against the best existing library, `times_faster` as fast.
std::vector<Goal> fastest_partition(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// One partition in every cell of the asks above, against the library itself, but for the scenes
/// that it is said to be unfit for.
std::vector<Goal> no_slower_than_existing(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// One partition on a scene against itself on another.
std::vector<Goal> scene_ratio(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// The fastest partition on several threads against the fastest on one.
std::vector<Goal> speedup(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// The instruction set chosen by default against each narrower one, frame by frame.
std::vector<Goal> default_isa(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Each kernel on a wide instruction set against itself on a narrow one.
std::vector<Goal> kernel_speedup(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

/// The fastest partition, one thread, over what memory alone asks for (see FrameLimit).
std::vector<Goal> near_limit(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// How one partition's time grows with the number of objects, one thread.
std::vector<Goal> growth_exponent(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

// other_kinds.cpp

/// What one partition holds without results, the most over the scenes and over 1 and 2 threads.
std::vector<Goal> bytes_per_object(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Nanoseconds of one operation on keys, the slowest partition.
std::vector<Goal> key_operation(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// The dearest over the cheapest of one operation among sizes, the worst partition.
std::vector<Goal> key_flatness(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Runs (partition x threads x instruction set) that differ from the reference in some frame.
std::vector<Goal> same_pairs(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

/// The same in every recording of a folder, given from where the tool is started; none if the
/// folder is not there.
std::vector<Goal> same_pairs_in_recordings(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

// query_kinds.cpp

/// One partition on one set of questions against another library, in the same run where that is
/// installed.
std::vector<Goal> query_speed(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// One partition's frustum against reading every box.
std::vector<Goal> frustum_speed(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Allocations of every partition when the same questions are asked again.
std::vector<Goal> query_allocations(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Partitions after many removals and insertions against fresh ones: pairs, rays and bytes.
std::vector<Goal> churn(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// One partition's frames with pair events in which few objects move against one in which all do.
std::vector<Goal> pair_events(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// One partition of many environments against a partition for each.
std::vector<Goal> many_worlds(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

// narrow_kinds.cpp

/// The tier robust on one kind of pairs at all levels against the best existing library, in this
/// run or elsewhere, `times_faster` as fast in cache and half that where the pairs stream from
/// memory.
std::vector<Goal> narrow_speed(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// The tier robust against the tier fast, all kinds.
std::vector<Goal> narrow_tiers(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Several threads against one, all kinds.
std::vector<Goal> narrow_threads(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Wrong verdicts, distances, bounds and normals of one tier, over all kinds and levels.
std::vector<Goal> narrow_accuracy(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Questions with reasoned answers in the files of a folder, given from where the tool is started,
/// to one tier; none if the folder is not there.
std::vector<Goal> narrow_hard_cases(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

// pipeline_kinds.cpp

/// winnow on a whole scene, on 1, 2, ... threads against what is asked and on one against other
/// libraries of the same run.
std::vector<Goal> pipeline_scene(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Triangles of two tori that meet, against FCL: in the same run, or elsewhere.
std::vector<Goal> pipeline_tori(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// Building a mesh's tree against FCL, and what it weighs.
std::vector<Goal> mesh_build(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// A frame of the granular flow against its phases, each by itself.
std::vector<Goal> flow_phases(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// A long granular flow: allocations, energy, and contacts against brute force.
std::vector<Goal> flow_soak(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

// choice_kinds.cpp

/// AutoPartition against the fastest partition of a cell: frames from the seventh on, and the first
/// six.
std::vector<Goal> choice_near_best(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// The same in every recording of a folder, given from where the tool is started; none if the
/// folder is not there.
std::vector<Goal> choice_in_recordings(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// What AutoPartition loses to the partition that is best after a scene has turned into another.
std::vector<Goal> choice_turn(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

// report_kinds.cpp

/// How long the default report takes, whether all of it was measured, and some of its figures,
/// picked at random, against their rows.
std::vector<Goal> report_default(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// A quick report without other libraries: whether it completes, and says so.
std::vector<Goal> report_without_peers(const Ask& ask, const std::vector<Ask>& all, Lab& lab);
/// What is left of a quick report that is killed once it has written rows.
std::vector<Goal> report_killed(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

/// Measured where there is no answer, or a wrong one, and less is better.
inline constexpr double kUnanswered = 1e6;

/// "100,000 objects, 2 threads"
[[nodiscard]] std::string on_size(std::size_t objects, int threads);

}  // namespace winnow::bench
