#pragma once

// Computes a local minimum of the depth of two cores from support points only; user shapes provide
// nothing else. At a minimum, the support point of the difference is on the line through the origin
// along the normal. The offset of the support point from that line is the gradient of the depth
// over the normals; Newton's method finds the zero of the gradient. Second derivatives come from
// differences and are updated by Broyden's rule ("A class of methods for solving nonlinear
// simultaneous equations", 1965). Used by curved_depth.wide.h and curved_search.wide.h.

#include "pipeline/kernels/curved/curved_minimum.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

class TangentMinimum {
 public:
  /// Starts from the unit direction `near`; `reach` is the extent of the difference. If the cores
  /// are `apart`, the depth is negative. Returns false if kMaxSteps steps find no smooth minimum
  /// within kWidest of the start.
  bool find(const CurvedPair& pair, const double* near, double reach, bool apart = false) {
    pair_ = &pair;
    const double miss = kMiss * reach;
    for (int k = 0; k < 3; ++k) from_[k] = near[k];
    span_across(from_, across_);
    const double start[2] = {0.0, 0.0};
    evaluate(start);
    if (!estimate_hessian()) return false;
    for (int i = 0; i < kMaxSteps; ++i) {
      double step[2];
      if (!next_step(step)) return false;
      const double before[2] = {slope_[0], slope_[1]};
      const double next[2] = {at_[0] + step[0], at_[1] + step[1]};
      if (!(dot2(next, next) <= kWidest * kWidest)) return false;
      evaluate(next);
      if (dot2(slope_, slope_) <= miss * miss) return apart ? height_ < 0.0 : height_ > 0.0;
      if (!(dot2(slope_, slope_) < dot2(before, before))) return false;
      broyden_update(step, before);
    }
    return false;
  }

  /// The unit normal from the first to the second; the support point of the difference along it,
  /// its height, and the first's point in it.
  [[nodiscard]] const double* normal() const { return normal_; }
  [[nodiscard]] const double* difference() const { return difference_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] const double* point() const { return mine_; }

 private:
  static constexpr int kMaxSteps = 12;
  /// The search ends if the distance of the support point from the line of the normal, relative to
  /// the extent of the difference, is at most this.
  static constexpr double kMiss = 1e-9;
  /// Tangents of angles: the largest distance from the start, and the step of the first
  /// differences.
  static constexpr double kWidest = 0.7;
  static constexpr double kAside = 0x1p-10;

  /// Evaluates the direction at the given tangents of angles from the start.
  void evaluate(const double* at) {
    for (int k = 0; k < 3; ++k) {
      normal_[k] = from_[k] + at[0] * across_[0][k] + at[1] * across_[1][k];
    }
    const double over = 1.0 / __builtin_sqrt(dot3(normal_, normal_));
    for (double& x : normal_) x *= over;
    difference_point(*pair_, normal_, difference_, mine_);
    height_ = dot3(normal_, difference_);
    const double along = dot3(from_, difference_);
    for (int i = 0; i < 2; ++i) {
      at_[i] = at[i];
      slope_[i] = dot3(across_[i], difference_) - at[i] * along;
    }
  }

  /// Computes the second derivatives by differences, column by column.
  bool estimate_hessian() {
    const double slope[2] = {slope_[0], slope_[1]};
    for (int i = 0; i < 2; ++i) {
      const double aside[2] = {i == 0 ? kAside : 0.0, i == 0 ? 0.0 : kAside};
      evaluate(aside);
      for (int k = 0; k < 2; ++k) hessian_[k][i] = (slope_[k] - slope[k]) / kAside;
    }
    const double mixed = 0.5 * (hessian_[0][1] + hessian_[1][0]);
    hessian_[0][1] = hessian_[1][0] = mixed;
    at_[0] = at_[1] = 0.0;
    slope_[0] = slope[0];
    slope_[1] = slope[1];
    return hessian_[0][0] > 0.0 && hessian_[0][0] * hessian_[1][1] > mixed * mixed;
  }

  bool next_step(double* step) const {
    const double det = hessian_[0][0] * hessian_[1][1] - hessian_[0][1] * hessian_[1][0];
    if (!(det > 0.0)) return false;
    step[0] = (hessian_[0][1] * slope_[1] - hessian_[1][1] * slope_[0]) / det;
    step[1] = (hessian_[1][0] * slope_[0] - hessian_[0][0] * slope_[1]) / det;
    return true;
  }

  /// Broyden's update: makes the second derivatives match the change along the step.
  void broyden_update(const double* step, const double* before) {
    const double square = dot2(step, step);
    if (!(square > 0.0)) return;
    for (int k = 0; k < 2; ++k) {
      const double miss = slope_[k] - before[k] - dot2(hessian_[k], step);
      for (int i = 0; i < 2; ++i) hessian_[k][i] += miss * step[i] / square;
    }
  }

  const CurvedPair* pair_;
  double from_[3];
  double across_[2][3];
  double at_[2];
  double slope_[2];
  double hessian_[2][2];
  double normal_[3];
  double difference_[3];
  double mine_[3];
  double height_;
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
