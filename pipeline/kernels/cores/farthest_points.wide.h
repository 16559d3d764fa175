#pragma once

// Support points of cores and of their Minkowski difference, for one pair at a time.

#include "pipeline/kernels/cores/curved_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// The support point of a core along d, in its frame.
static inline void farthest(const CoreDesc& form, const double* d, double scale, double* x) {
  const double* n = form.number;
  const auto towards = [](double along, double half) { return along < 0.0 ? -half : half; };
  switch (form.kind) {
    case ShapeKind::sphere:
      for (int k = 0; k < 3; ++k) x[k] = 0.0;
      return;
    case ShapeKind::capsule:
      x[0] = 0.0;
      x[1] = 0.0;
      x[2] = towards(d[2], n[2]);
      return;
    case ShapeKind::box:
      for (int k = 0; k < 3; ++k) x[k] = towards(d[k], n[k]);
      return;
    case ShapeKind::triangle: {
      const double h[3] = {dot3(n, d), dot3(n + 3, d), dot3(n + 6, d)};
      const int best = h[1] > h[0] ? 1 : 0;
      const int vertex = h[2] > h[best] ? 2 : best;
      for (int k = 0; k < 3; ++k) x[k] = n[3 * vertex + k];
      return;
    }
    case ShapeKind::cylinder:
    case ShapeKind::cone: {
      const double across = __builtin_sqrt(d[0] * d[0] + d[1] * d[1]);
      const double tip = n[2] * d[2];
      const bool cone = form.kind == ShapeKind::cone;
      const bool on_tip = cone && tip >= n[0] * across - tip;
      const double over = on_tip ? 0.0 : n[0] / largest_of(across, 1e-150);
      x[0] = d[0] * over;
      x[1] = d[1] * over;
      x[2] = cone ? (on_tip ? n[2] : -n[2]) : towards(d[2], n[2]);
      return;
    }
    case ShapeKind::ellipsoid: {
      const double stretched[3] = {n[0] * d[0], n[1] * d[1], n[2] * d[2]};
      const double length = __builtin_sqrt(dot3(stretched, stretched));
      const double over = 1.0 / largest_of(length, 1e-150);
      const double off = n[3] / __builtin_sqrt(dot3(d, d));
      for (int k = 0; k < 3; ++k) x[k] = n[k] * (stretched[k] * over) - off * d[k];
      return;
    }
    case ShapeKind::tapered_capsule: {
      const double length = __builtin_sqrt(dot3(d, d));
      const bool on_tip = (n[2] - n[1]) * d[2] >= n[0] * length;
      const double over = on_tip ? 0.0 : n[0] / largest_of(length, 1e-150);
      x[0] = d[0] * over;
      x[1] = d[1] * over;
      x[2] = on_tip ? n[2] : n[1] + d[2] * over;
      return;
    }
    default:
      single_support(form, d, scale, x);
  }
}

/// The support point w of first - second along n, and the point `mine` of the first in it.
static inline void difference_point(const CurvedPair& pair, const double* n, double* w,
                                    double* mine) {
  double back[3];
  double local[3];
  double theirs[3];
  farthest(pair.first, n, pair.scale, mine);
  turn_back3(pair.turn, n, back);
  for (double& x : back) x = -x;
  farthest(pair.second, back, pair.scale, local);
  turn3(pair.turn, local, theirs);
  for (int k = 0; k < 3; ++k) w[k] = mine[k] - (theirs[k] + pair.shift[k]);
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
