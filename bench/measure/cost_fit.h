#pragma once

#include <winnow/partitions/scene_features.h>
#include "bench/scenes/frame_source.h"
#include "partitions/choice/predicted_costs.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// What the structures that the automatic choice chooses from took for frames of one scene.
struct CostSample {
  std::string scene;
  double moving = 1.0;  ///< share of the objects that moves in a frame
  SceneFeatures features;
  FrameWork work;
  double pairs = 0.0;         ///< of a frame
  std::vector<double> frame;  ///< ns, by candidate: midway between the median and the mean frame
  std::vector<double> first;  ///< ns, by candidate: of the frame in which it was built
};

/// A scene of which only a share of the objects moves in each frame, the others in turn; one that
/// grows stays as it is.
[[nodiscard]] std::unique_ptr<FrameSource> some_moving(std::unique_ptr<FrameSource> scene,
                                                       double share);

/// Races all candidates on a scene, interleaved, on one thread.
[[nodiscard]] CostSample measure_costs(FrameSource& scene, double moving, std::size_t frames);

/// Constants that were fitted, and how far their predictions are off.
struct FittedCosts {
  std::vector<StructureCosts> costs;  ///< by candidate; those of other queries as they are
  std::vector<double> error;          ///< by candidate: median relative error of a frame
};

/// Least squares of the relative errors, without negative constants (Lawson and Hanson, "Solving
/// Least Squares Problems", 1974, chapter 23, here by coordinate descent), from which constants are
/// sought that choose better: what a wrong choice costs decides, not how far a prediction is off.
/// Where a candidate is far from the best its error matters less: it need only be known not to be
/// chosen.
[[nodiscard]] FittedCosts fit_costs(const std::vector<CostSample>& samples);

/// The constants that the library has.
[[nodiscard]] std::vector<StructureCosts> present_costs();

/// What the cheapest prediction takes over what the best candidate takes, once settled.
[[nodiscard]] double regret_of(const CostSample& sample, const std::vector<StructureCosts>& costs,
                               std::size_t& chosen, std::size_t& best);

}  // namespace winnow::bench
