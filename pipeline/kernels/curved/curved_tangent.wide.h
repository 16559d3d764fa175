#pragma once

// Where the depth of two cores has a local minimum, as their farthest points alone tell: of a
// program's own sets nothing else is known. The farthest point of the difference along a normal is
// then on the normal. Its way off that is the slope of the depth over the normals, whose zero
// Newton's method finds, with slopes of slopes by differences and, from step to step, by Broyden's
// rule ("A class of methods for solving nonlinear simultaneous equations", 1965).

#include "pipeline/kernels/curved/curved_minimum.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

class TangentMinimum {
 public:
  /// From a unit direction, of a difference that reaches so far. Where the cores are `apart` the
  /// depth is below zero. False if there is none near that is smooth.
  bool find(const CurvedPair& pair, const double* near, double reach, bool apart = false) {
    pair_ = &pair;
    const double miss = kMiss * reach;
    for (int k = 0; k < 3; ++k) from_[k] = near[k];
    span_across(from_, across_);
    const double start[2] = {0.0, 0.0};
    look(start);
    if (!take_bends()) return false;
    for (int i = 0; i < kMostSteps; ++i) {
      double step[2];
      if (!next_step(step)) return false;
      const double before[2] = {slope_[0], slope_[1]};
      const double next[2] = {at_[0] + step[0], at_[1] + step[1]};
      if (!(dot2(next, next) <= kWidest * kWidest)) return false;
      look(next);
      if (dot2(slope_, slope_) <= miss * miss) return apart ? height_ < 0.0 : height_ > 0.0;
      if (!(dot2(slope_, slope_) < dot2(before, before))) return false;
      learn(step, before);
    }
    return false;
  }

  /// Unit, from the first to the second; the point of the difference that is farthest along it, how
  /// far that is, and the first's point in it.
  [[nodiscard]] const double* normal() const { return normal_; }
  [[nodiscard]] const double* difference() const { return difference_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] const double* point() const { return mine_; }

 private:
  static constexpr int kMostSteps = 12;
  /// How far the farthest point may be off its normal, over what the difference measures.
  static constexpr double kMiss = 1e-9;
  /// Of tangents of angles: the farthest from where the search began, and the first differences.
  static constexpr double kWidest = 0.7;
  static constexpr double kAside = 0x1p-10;

  /// At tangents of angles from where the search began.
  void look(const double* at) {
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

  /// Of the slopes, by column.
  bool take_bends() {
    const double slope[2] = {slope_[0], slope_[1]};
    for (int i = 0; i < 2; ++i) {
      const double aside[2] = {i == 0 ? kAside : 0.0, i == 0 ? 0.0 : kAside};
      look(aside);
      for (int k = 0; k < 2; ++k) bend_[k][i] = (slope_[k] - slope[k]) / kAside;
    }
    const double mixed = 0.5 * (bend_[0][1] + bend_[1][0]);
    bend_[0][1] = bend_[1][0] = mixed;
    at_[0] = at_[1] = 0.0;
    slope_[0] = slope[0];
    slope_[1] = slope[1];
    return bend_[0][0] > 0.0 && bend_[0][0] * bend_[1][1] > mixed * mixed;
  }

  bool next_step(double* step) const {
    const double det = bend_[0][0] * bend_[1][1] - bend_[0][1] * bend_[1][0];
    if (!(det > 0.0)) return false;
    step[0] = (bend_[0][1] * slope_[1] - bend_[1][1] * slope_[0]) / det;
    step[1] = (bend_[1][0] * slope_[0] - bend_[0][0] * slope_[1]) / det;
    return true;
  }

  /// Makes the bends tell what the step changed.
  void learn(const double* step, const double* before) {
    const double square = dot2(step, step);
    if (!(square > 0.0)) return;
    for (int k = 0; k < 2; ++k) {
      const double miss = slope_[k] - before[k] - dot2(bend_[k], step);
      for (int i = 0; i < 2; ++i) bend_[k][i] += miss * step[i] / square;
    }
  }

  const CurvedPair* pair_;
  double from_[3];
  double across_[2][3];
  double at_[2];
  double slope_[2];
  double bend_[2][2];
  double normal_[3];
  double difference_[3];
  double mine_[3];
  double height_;
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
