#pragma once

#include <winnow/partitions/structures.h>
#include "bench/scenes/frame_source.h"
#include "partitions/choice/predicted_costs.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// Times of AutoPartition's candidates on frames of one scene.
struct CostSample {
  std::string scene;
  double moving = 1.0;  ///< share of the objects that move in a frame
  SceneFeatures features;
  FrameWork work;
  double pairs = 0.0;         ///< per frame
  std::vector<double> frame;  ///< ns, by candidate: average of the median and the mean of frames
  std::vector<double> first;  ///< ns, by candidate: the frame in which it was built
};

/// Returns a scene in which only a share of the objects moves in each frame, each object in its
/// turn. Scenes that grow are returned unchanged.
[[nodiscard]] std::unique_ptr<FrameSource> some_moving(std::unique_ptr<FrameSource> scene,
                                                       double share);

/// Races all candidates on a scene, interleaved, on one thread.
[[nodiscard]] CostSample measure_costs(FrameSource& scene, double moving, std::size_t frames);

/// Fitted constants and the errors of their predictions.
struct FittedCosts {
  std::vector<StructureCosts> costs;  ///< by candidate; constants of other queries are unchanged
  std::vector<double> error;          ///< by candidate: median relative error of a frame
};

/// Fits constants by nonnegative least squares of the relative errors (Lawson and Hanson, "Solving
/// Least Squares Problems", 1974, chapter 23; here by coordinate descent), then improves the
/// choices by a search whose loss is mainly the time lost by wrong choices. The slower a candidate
/// is relative to the best, the less its error counts: its prediction must only exceed the
/// prediction for the best.
[[nodiscard]] FittedCosts fit_costs(const std::vector<CostSample>& samples);

/// Returns the constants that the library uses now.
[[nodiscard]] std::vector<StructureCosts> present_costs();

/// Returns the settled time of the candidate with the cheapest prediction over the time of the best
/// candidate.
[[nodiscard]] double regret_of(const CostSample& sample, const std::vector<StructureCosts>& costs,
                               std::size_t& chosen, std::size_t& best);

}  // namespace winnow::bench
