#pragma once

// Two boxes in the frame of a, and their separation along the fifteen axes of Gottschalk (1996):
// 0 to 2 the faces of a, 3 to 5 those of b, 6 + 3 i + j the product of axis i of a and axis j of b.

#include "pipeline/kernels/flat/flat.wide.h"

namespace winnow::WINNOW_ISA_NAME {

template <typename T>
struct BoxPair {
  Lanes<T> half_a[3];
  Lanes<T> half_b[3];
  /// Axis j of b is the column turn[0..2][j].
  Lanes<T> turn[3][3];
  /// Center of b, along the axes of a and along those of b.
  Lanes<T> center[3];
  Lanes<T> center_b[3];
  Lanes<T> rounding_a;
  Lanes<T> rounding_b;
  /// The sum of all lengths.
  Lanes<T> scale;
  Vec3<T> offset;
  Rotation<T> frame_a;
  Rotation<T> frame_b;

  [[gnu::always_inline]] BoxPair(const NarrowJob& job, const PairBlock<T>& block) {
    offset = load_offset(job, block);
    frame_a = rotation(load_turn<SideA>(job, block));
    frame_b = rotation(load_turn<SideB>(job, block));
    const Vec3<T> columns[3] = {frame_a.to_local(frame_b.x), frame_a.to_local(frame_b.y),
                                frame_a.to_local(frame_b.z)};
    for (int j = 0; j < 3; ++j) {
      turn[0][j] = columns[j].x;
      turn[1][j] = columns[j].y;
      turn[2][j] = columns[j].z;
    }
    const Vec3<T> c = frame_a.to_local(offset);
    center[0] = c.x;
    center[1] = c.y;
    center[2] = c.z;
    for (int j = 0; j < 3; ++j) center_b[j] = dot(columns[j], c);
    const BoxLanes<T> a = load_box<SideA>(job, block);
    const BoxLanes<T> b = load_box<SideB>(job, block);
    half_a[0] = a.half.x;
    half_a[1] = a.half.y;
    half_a[2] = a.half.z;
    half_b[0] = b.half.x;
    half_b[1] = b.half.y;
    half_b[2] = b.half.z;
    rounding_a = a.rounding;
    rounding_b = b.rounding;
    scale = abs(c.x) + abs(c.y) + abs(c.z) + half_a[0] + half_a[1] + half_a[2] + half_b[0] +
            half_b[1] + half_b[2] + rounding_a + rounding_b;
    // Not a number for a bad orientation of b either.
    scale += turn[0][0] * Lanes<T>(T(0));
  }

  [[gnu::always_inline]] Lanes<T> face_a(int i) const {
    return abs(center[i]) - half_a[i] -
           (abs(turn[i][0]) * half_b[0] + abs(turn[i][1]) * half_b[1] +
            abs(turn[i][2]) * half_b[2]);
  }
  [[gnu::always_inline]] Lanes<T> face_b(int j) const {
    return abs(center_b[j]) - half_b[j] -
           (abs(turn[0][j]) * half_a[0] + abs(turn[1][j]) * half_a[1] +
            abs(turn[2][j]) * half_a[2]);
  }
  /// Along the product of two axes, which is shorter than 1.
  [[gnu::always_inline]] Lanes<T> edges(int i, int j) const {
    const int k = (i + 1) % 3;
    const int l = (i + 2) % 3;
    const int m = (j + 1) % 3;
    const int n = (j + 2) % 3;
    const Lanes<T> apart = abs(turn[k][j] * center[l] - turn[l][j] * center[k]);
    const Lanes<T> reach_a = half_a[k] * abs(turn[l][j]) + half_a[l] * abs(turn[k][j]);
    const Lanes<T> reach_b = half_b[m] * abs(turn[i][n]) + half_b[n] * abs(turn[i][m]);
    return apart - (reach_a + reach_b);
  }
  /// Along any unit vector from a to b, in the frame of a.
  [[gnu::always_inline]] Lanes<T> along(const Lanes<T> (&n)[3]) const {
    Lanes<T> reach = abs(n[0]) * half_a[0] + abs(n[1]) * half_a[1] + abs(n[2]) * half_a[2];
    for (int j = 0; j < 3; ++j) {
      reach += abs(n[0] * turn[0][j] + n[1] * turn[1][j] + n[2] * turn[2][j]) * half_b[j];
    }
    return n[0] * center[0] + n[1] * center[1] + n[2] * center[2] - reach;
  }
  [[gnu::always_inline]] Vec3<T> to_world(const Lanes<T> (&v)[3]) const {
    return frame_a.to_world({v[0], v[1], v[2]});
  }
};

/// The axis of the largest separation.
template <typename T>
struct BoxAxis {
  /// Unit, from a to b, in the frame of a.
  Lanes<T> normal[3];
  Lanes<T> separation;
  /// No unit vector separates more.
  Lanes<T> most;
  Lanes<T> index;
  /// Square of the length of a product of edges.
  Lanes<T> length2;
};

/// The largest separation along the fifteen axes, unscaled: enough for a verdict where no edges
/// are parallel.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> largest_face_separation(const BoxPair<T>& pair) {
  Lanes<T> s = max(pair.face_a(0), pair.face_b(0));
  for (int i = 1; i < 3; ++i) s = max(s, max(pair.face_a(i), pair.face_b(i)));
  return s;
}
template <typename T>
[[gnu::always_inline]] inline Lanes<T> largest_edge_separation(const BoxPair<T>& pair) {
  Lanes<T> s = pair.edges(0, 0);
  for (int k = 1; k < 9; ++k) s = max(s, pair.edges(k / 3, k % 3));
  return s;
}

/// The axis of a number, of any sign.
template <typename T>
[[gnu::always_inline]] inline void axis_of(const BoxPair<T>& pair, const Lanes<T>& index,
                                           Lanes<T> (&axis)[3]) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const LaneMask<T> face_of_a = index < Lanes<T>(T(2.5));
  const LaneMask<T> product = index > Lanes<T>(T(5.5));
  const Lanes<T> k = select(product, index - Lanes<T>(T(6)), index);
  // Row i of a product, or the face of a; column j.
  const LaneMask<T> past_two = k > Lanes<T>(T(2.5));
  const LaneMask<T> past_five = k > Lanes<T>(T(5.5));
  const Lanes<T> three = select(past_five, Lanes<T>(T(6)), select(past_two, Lanes<T>(T(3)), zero));
  const Lanes<T> j = k - three;
  const LaneMask<T> j1 = j > Lanes<T>(T(0.5));
  const LaneMask<T> j2 = j > Lanes<T>(T(1.5));
  Lanes<T> b[3];
  for (int r = 0; r < 3; ++r) {
    b[r] = select(j2, pair.turn[r][2], select(j1, pair.turn[r][1], pair.turn[r][0]));
  }
  // Axis i of a times b: two of b's numbers, one of them negated.
  const LaneMask<T> i0 = !past_two;
  const LaneMask<T> i2 = past_five;
  const Lanes<T> cross[3] = {select(i0, zero, select(i2, -b[1], b[2])),
                             select(i0, -b[2], select(i2, b[0], zero)),
                             select(i0, b[1], select(i2, zero, -b[0]))};
  const Lanes<T> unit[3] = {select(j1, zero, one), select(j2, zero, select(j1, one, zero)),
                            select(j2, one, zero)};
  for (int r = 0; r < 3; ++r) {
    axis[r] = select(face_of_a, unit[r], select(product, cross[r], b[r]));
  }
}

/// Offers the nine products; those of parallel edges are left out. A separation along one of them
/// is at most the largest of the others and the shorter edge's reach along it: seen along the
/// edges, the boxes are a rectangle and a parallelogram but for that, and the sides' normals are
/// among the axes. Returns the largest reach left out.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> offer_edges(const BoxPair<T>& pair, const Lanes<T>& slack,
                                                   BestAxis<T>& best) {
  Lanes<T> square[3][3];
  for (int k = 0; k < 9; ++k)
    square[k / 3][k % 3] = pair.turn[k / 3][k % 3] * pair.turn[k / 3][k % 3];
  Lanes<T> least = square[1][0] + square[2][0];
  for (int k = 1; k < 9; ++k) {
    const int i = k / 3;
    least = min(least, square[(i + 1) % 3][k % 3] + square[(i + 2) % 3][k % 3]);
  }
  const Lanes<T> parallel(kParallelSquare<T>);
  Lanes<T> left_out(T(0));
  if (bits(least > parallel) == kAllLanes<T>) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        best.offer(pair.edges(i, j) + slack, square[(i + 1) % 3][j] + square[(i + 2) % 3][j],
                   6 + 3 * i + j);
      }
    }
    return left_out;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Lanes<T> length2 = square[(i + 1) % 3][j] + square[(i + 2) % 3][j];
      const LaneMask<T> crossed = length2 > parallel;
      const Lanes<T> reach =
          pair.half_b[j] * (abs(pair.turn[(i + 1) % 3][j]) + abs(pair.turn[(i + 2) % 3][j]));
      left_out = max(left_out, select(crossed, Lanes<T>(T(0)), reach));
      best.offer(select(crossed, pair.edges(i, j) + slack, -pair.scale),
                 select(crossed, length2, Lanes<T>(T(1))), 6 + 3 * i + j);
    }
  }
  return left_out;
}

template <typename T>
[[gnu::always_inline]] inline BoxAxis<T> best_axis(const BoxPair<T>& pair) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kSlack<T>);
  BestFace<T> face{pair.face_a(0), Lanes<T>(T(0))};
  for (int i = 1; i < 3; ++i) face.offer(pair.face_a(i), i);
  for (int j = 0; j < 3; ++j) face.offer(pair.face_b(j), 3 + j);
  face.separation += slack;
  BestAxis<T> best = face.as_axis();
  const Lanes<T> left_out = offer_edges(pair, slack, best);

  BoxAxis<T> r;
  r.index = best.index;
  r.length2 = best.length2;
  r.most = best.separation() + left_out;
  Lanes<T> axis[3];
  axis_of(pair, best.index, axis);
  const Lanes<T> apart =
      axis[0] * pair.center[0] + axis[1] * pair.center[1] + axis[2] * pair.center[2];
  const Lanes<T> shrink = sign_or_one(apart) / sqrt(best.length2);
  for (int k = 0; k < 3; ++k) r.normal[k] = axis[k] * shrink;
  r.separation = pair.along(r.normal);
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
