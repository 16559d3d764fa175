#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace winnow::bench {

// What a partition costs over time, on one thread; on `uniform` unless a scene is named.

/// After `operations` single removals and insertions of random objects, in frames of a tenth of the
/// objects with pairs found after each, over a fresh partition of the same objects: the time of all
/// "self pairs" anew and of closest hits of single "rays", and "bytes" without results.
[[nodiscard]] std::vector<std::pair<std::string_view, double>> measure_churn(
    std::string_view partition, std::size_t objects, std::size_t operations);

/// Milliseconds of frames in which a share of the objects moves, by share: updating them, and the
/// pairs that began and ended.
[[nodiscard]] std::vector<std::vector<double>> measure_event_frames(
    std::string_view partition, std::size_t objects, const std::vector<double>& shares);

/// Milliseconds of frames of a scene in which the same objects move in every frame, one frame after
/// another with nothing between them: what a program pays that has its data in the caches.
[[nodiscard]] std::vector<double> measure_quiet_frames(std::string_view partition,
                                                       std::string_view scene, std::size_t objects,
                                                       std::size_t frames);

/// Milliseconds of frames of many small worlds in which everything moves: together in one
/// partition, in which each world is an environment, and apart in a partition for each.
[[nodiscard]] std::array<std::vector<double>, 2> measure_worlds(std::string_view partition,
                                                                std::size_t worlds,
                                                                std::size_t objects_each);

}  // namespace winnow::bench
