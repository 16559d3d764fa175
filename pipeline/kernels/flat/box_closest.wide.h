#pragma once

// Closest and deepest points of two boxes. Where a vertex meets a face, or two edges cross, the
// best of the fifteen axes is the normal; what else there is has a vertex on one side, so that the
// closest of sixteen vertices to the other box is the answer.

#include "pipeline/kernels/flat/box_axes.wide.h"

namespace winnow::WINNOW_ISA_NAME {

template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp(const Lanes<T>& v, const Lanes<T>& reach) {
  return max(min(v, reach), -reach);
}

template <typename T>
[[gnu::always_inline]] inline Lanes<T> square_of(const Lanes<T> (&v)[3]) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

/// A point of each box, in the frame of a.
template <typename T>
struct BoxPoints {
  Lanes<T> a[3];
  Lanes<T> b[3];
};

/// From b's axes to the frame of a, and back.
template <typename T>
[[gnu::always_inline]] inline void from_b(const BoxPair<T>& pair, const Lanes<T> (&q)[3],
                                          Lanes<T> (&p)[3]) {
  for (int r = 0; r < 3; ++r) {
    p[r] =
        pair.center[r] + (pair.turn[r][0] * q[0] + pair.turn[r][1] * q[1] + pair.turn[r][2] * q[2]);
  }
}
template <typename T>
[[gnu::always_inline]] inline void to_b(const BoxPair<T>& pair, const Lanes<T> (&p)[3],
                                        Lanes<T> (&q)[3]) {
  const Lanes<T> d[3] = {p[0] - pair.center[0], p[1] - pair.center[1], p[2] - pair.center[2]};
  for (int j = 0; j < 3; ++j) {
    q[j] = pair.turn[0][j] * d[0] + pair.turn[1][j] * d[1] + pair.turn[2][j] * d[2];
  }
}

/// Where the boxes come closest along an axis: the vertices that reach farthest, or the points of
/// two edges. In a's frame the point of a, in b's axes that of b.
template <typename T>
struct BoxReach {
  Lanes<T> a[3];
  Lanes<T> b[3];
};

template <typename T>
[[gnu::always_inline]] inline BoxReach<T> reach_along(const BoxPair<T>& pair,
                                                      const BoxAxis<T>& axis) {
  BoxReach<T> r;
  for (int i = 0; i < 3; ++i) r.a[i] = sign_or_one(axis.normal[i]) * pair.half_a[i];
  for (int j = 0; j < 3; ++j) {
    const Lanes<T> rise = axis.normal[0] * pair.turn[0][j] + axis.normal[1] * pair.turn[1][j] +
                          axis.normal[2] * pair.turn[2][j];
    r.b[j] = -sign_or_one(rise) * pair.half_b[j];
  }
  return r;
}

/// Replaces the vertices by the closest points of the edges through them, for products of edges.
template <typename T>
[[gnu::always_inline]] inline void move_along_edges(const BoxPair<T>& pair, const BoxAxis<T>& axis,
                                                    BoxReach<T>& reach) {
  const Lanes<T> zero(T(0));
  const Lanes<T> k = axis.index - Lanes<T>(T(6));
  const LaneMask<T> product = axis.index > Lanes<T>(T(5.5));
  const LaneMask<T> i1 = k > Lanes<T>(T(2.5));
  const LaneMask<T> i2 = k > Lanes<T>(T(5.5));
  const Lanes<T> j = k - select(i2, Lanes<T>(T(6)), select(i1, Lanes<T>(T(3)), zero));
  const LaneMask<T> is_i[3] = {product & !i1, product & i1 & !i2, product & i2};
  const LaneMask<T> j1 = j > Lanes<T>(T(0.5));
  const LaneMask<T> j2 = j > Lanes<T>(T(1.5));
  const LaneMask<T> is_j[3] = {product & !j1, product & j1 & !j2, product & j2};
  for (int r = 0; r < 3; ++r) {
    reach.a[r] = select(is_i[r], zero, reach.a[r]);
    reach.b[r] = select(is_j[r], zero, reach.b[r]);
  }
  // From the middle of a's edge to that of b's, along either edge.
  Lanes<T> b[3];
  from_b(pair, reach.b, b);
  const Lanes<T> w[3] = {b[0] - reach.a[0], b[1] - reach.a[1], b[2] - reach.a[2]};
  Lanes<T> edge_b[3];
  for (int r = 0; r < 3; ++r) {
    edge_b[r] = select(is_j[2], pair.turn[r][2], select(is_j[1], pair.turn[r][1], pair.turn[r][0]));
  }
  const Lanes<T> along_a = select(is_i[2], w[2], select(is_i[1], w[1], w[0]));
  const Lanes<T> cosine = select(is_i[2], edge_b[2], select(is_i[1], edge_b[1], edge_b[0]));
  const Lanes<T> along_b = w[0] * edge_b[0] + w[1] * edge_b[1] + w[2] * edge_b[2];
  const Lanes<T> s = (along_a - cosine * along_b) / axis.length2;
  const Lanes<T> t = s * cosine - along_b;
  for (int r = 0; r < 3; ++r) {
    reach.a[r] = select(is_i[r], clamp(s, pair.half_a[r]), reach.a[r]);
    reach.b[r] = select(is_j[r], clamp(t, pair.half_b[r]), reach.b[r]);
  }
}

/// The vertex center +- arm[0] +- arm[1] +- arm[2] that is closest to a box about the origin.
template <typename T>
struct NearestVertex {
  Lanes<T> square;
  Lanes<T> sign[3];

  [[gnu::always_inline]] NearestVertex(const Lanes<T> (&center)[3], const Lanes<T> (&arm)[3][3],
                                       const Lanes<T> (&half)[3]) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    square = Lanes<T>(sizeof(T) == sizeof(double) ? T(1e300) : T(1e38F));
    for (int r = 0; r < 3; ++r) sign[r] = one;
    for (int pair = 0; pair < 4; ++pair) {
      Lanes<T> base[3];
      for (int r = 0; r < 3; ++r) {
        const Lanes<T> first = (pair & 1) != 0 ? center[r] - arm[0][r] : center[r] + arm[0][r];
        base[r] = (pair & 2) != 0 ? first - arm[1][r] : first + arm[1][r];
      }
      for (int last = 0; last < 2; ++last) {
        Lanes<T> out[3];
        for (int r = 0; r < 3; ++r) {
          const Lanes<T> p = last != 0 ? base[r] - arm[2][r] : base[r] + arm[2][r];
          out[r] = max(abs(p) - half[r], zero);
        }
        const Lanes<T> d = square_of(out);
        const LaneMask<T> nearer = d < square;
        square = select(nearer, d, square);
        sign[0] = select(nearer, (pair & 1) != 0 ? -one : one, sign[0]);
        sign[1] = select(nearer, (pair & 2) != 0 ? -one : one, sign[1]);
        sign[2] = select(nearer, last != 0 ? -one : one, sign[2]);
      }
    }
  }
};

/// Closest points of boxes that are apart.
template <typename T>
[[gnu::always_inline]] inline BoxPoints<T> closest_points(const BoxPair<T>& pair,
                                                          const BoxAxis<T>& axis,
                                                          const BoxReach<T>& reach) {
  Lanes<T> arm_a[3][3];
  Lanes<T> arm_b[3][3];
  const Lanes<T> center_a[3] = {-pair.center_b[0], -pair.center_b[1], -pair.center_b[2]};
  for (int i = 0; i < 3; ++i) {
    for (int r = 0; r < 3; ++r) {
      arm_a[i][r] = pair.turn[i][r] * pair.half_a[i];
      arm_b[i][r] = pair.turn[r][i] * pair.half_b[i];
    }
  }
  const NearestVertex<T> of_b(pair.center, arm_b, pair.half_a);
  const NearestVertex<T> of_a(center_a, arm_a, pair.half_b);

  BoxPoints<T> edges;
  from_b(pair, reach.b, edges.b);
  Lanes<T> between[3];
  for (int r = 0; r < 3; ++r) between[r] = edges.b[r] - reach.a[r];
  const LaneMask<T> product = axis.index > Lanes<T>(T(5.5));
  const Lanes<T> nearest = min(of_a.square, of_b.square);
  const LaneMask<T> by_edges = product & (square_of(between) <= nearest);
  const LaneMask<T> vertex_of_b = of_b.square <= of_a.square;

  // A vertex of a and the point of b next to it, then one of b and the point of a.
  Lanes<T> vertex_a[3];
  Lanes<T> next_to_a[3];
  for (int r = 0; r < 3; ++r) vertex_a[r] = of_a.sign[r] * pair.half_a[r];
  to_b(pair, vertex_a, next_to_a);
  Lanes<T> b[3];
  for (int j = 0; j < 3; ++j) {
    b[j] = select(
        by_edges, reach.b[j],
        select(vertex_of_b, of_b.sign[j] * pair.half_b[j], clamp(next_to_a[j], pair.half_b[j])));
  }
  BoxPoints<T> points;
  from_b(pair, b, points.b);
  for (int r = 0; r < 3; ++r) {
    points.a[r] = select(by_edges, reach.a[r],
                         select(vertex_of_b, clamp(points.b[r], pair.half_a[r]), vertex_a[r]));
  }
  return points;
}

}  // namespace winnow::WINNOW_ISA_NAME
