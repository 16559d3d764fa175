#pragma once

#include "pipeline/motion/moving_pair.h"

#include <Eigen/Core>

#include <cmath>

namespace winnow {

/// A time after the end of the motion (time 1): the balls do not overlap.
inline constexpr double kNever = 2.0;

/// The bounding ball of a body that moves.
struct MovingBall {
  double start[3];
  double travel[3];
  double radius;
};

/// Relative motion of the bounding balls of two bodies.
struct Approach {
  Eigen::Vector3d between;
  Eigen::Vector3d travel;
  double reach;

  [[nodiscard]] impact::Interval window() const noexcept {
    return impact::ball_window(between, travel, reach);
  }
  /// Returns a lower bound on the time at which the balls first overlap, or kNever: the smaller
  /// root of a quadratic whose coefficients are rounded towards an earlier time. Most balls overlap
  /// at the start, which needs no root.
  [[nodiscard]] double begin() const noexcept {
    constexpr double kSlack = 1e-12;
    constexpr double kSquares = 1e150;
    const double square = between.squaredNorm();
    const double beyond = square - reach * reach - kSlack * square;
    if (beyond <= 0.0) return 0.0;
    const double speed = travel.squaredNorm();
    if (!(square * speed < kSquares && square * speed > 1.0 / kSquares)) return rough_begin();
    const double nearing = -between.dot(travel);
    if (nearing <= 0.0) return kNever;
    const double root = nearing * nearing - speed * beyond + kSlack * (square * speed);
    if (root < 0.0) return kNever;
    const double begin = beyond / (nearing + std::sqrt(root));
    return begin <= 1.0 ? begin : kNever;
  }

 private:
  [[nodiscard]] double rough_begin() const noexcept {
    const impact::Interval overlap = window();
    return overlap.first <= overlap.last ? overlap.first : kNever;
  }
};

}  // namespace winnow
