#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A partition after random removals and insertions, over a fresh one of the same objects.
struct ChurnCosts {
  double self_pairs = 0.0;  ///< time of all pairs anew
  double rays = 0.0;        ///< time of closest hits of single rays
  double bytes = 0.0;       ///< footprint without results
  double bytes_an_object = 0.0;
};

/// On one thread: `operations` single removals and insertions of random objects of `uniform`, in
/// frames of a tenth of the objects, with pairs found after each.
[[nodiscard]] ChurnCosts measure_churn(std::string_view partition, std::size_t objects,
                                       std::size_t operations);

/// Milliseconds of a frame of `uniform` in which a share of the objects moves: updating them, and
/// the pairs that began and ended. On one thread; medians of rounds in which the shares take turns.
/// Throws Refusal.
[[nodiscard]] std::vector<double> measure_event_frames(std::string_view partition,
                                                       std::size_t objects,
                                                       const std::vector<double>& shares);

/// A frame of many small worlds in which everything moves, on one thread.
struct WorldCosts {
  double together_ms = 0.0;  ///< one partition, in which each world is an environment
  double apart_ms = 0.0;     ///< a partition for each
  bool same_pairs = false;
};

/// Throws Refusal.
[[nodiscard]] WorldCosts measure_worlds(std::string_view partition, std::size_t worlds,
                                        std::size_t objects_each);

}  // namespace winnow::bench
