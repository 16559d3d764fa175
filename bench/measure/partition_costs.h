#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace winnow::bench {

// Costs of a partition over time, on one thread; on `uniform` unless a scene is named.

/// Replaces random objects by `operations` / 2 removals and as many insertions, and finds pairs
/// each time a tenth of the objects has been replaced. Returns the ratios of this partition to a
/// new one with the same objects: time of all "self pairs" without incremental data, time of
/// closest hits of single "rays", and "bytes" without results.
[[nodiscard]] std::vector<std::pair<std::string_view, double>> measure_churn(
    std::string_view partition, std::size_t objects, std::size_t operations);

/// Returns milliseconds of frames in which a share of the objects moves, by share: their update,
/// and the pairs that began and ended.
[[nodiscard]] std::vector<std::vector<double>> measure_event_frames(
    std::string_view partition, std::size_t objects, const std::vector<double>& shares);

/// Returns milliseconds of consecutive frames in which the same objects move, with nothing in
/// between: the cost for a program whose data stay in the caches.
[[nodiscard]] std::vector<double> measure_quiet_frames(std::string_view partition,
                                                       std::string_view scene, std::size_t objects,
                                                       std::size_t frames);

/// Returns milliseconds of frames of many small worlds in which everything moves: first with all
/// worlds as environments of one partition, then with one partition per world.
[[nodiscard]] std::array<std::vector<double>, 2> measure_worlds(std::string_view partition,
                                                                std::size_t worlds,
                                                                std::size_t objects_each);

}  // namespace winnow::bench
