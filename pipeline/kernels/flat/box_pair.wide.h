#pragma once

// Two boxes in the frame of a, and their separation along the fifteen SAT axes (Gottschalk 1996): 0
// to 2 are the faces of a, 3 to 5 the faces of b, 6 + 3 i + j is the cross product of axis i of a
// and axis j of b.
//
// Closest and deepest points of two boxes: if they are on a vertex and a face, or on two edges that
// cross, the best of the fifteen axes is the normal. In all other cases one of the closest points
// is a vertex: the one of the sixteen vertices that is closest to the other box. Used by
// box_box.kernel.cpp.

#include "pipeline/kernels/flat/flat.wide.h"
#include "pipeline/kernels/shared_by_levels.wide.h"

namespace winnow::WINNOW_ISA_NAME::flat {

template <typename T>
struct BoxPair {
  Lanes<T> half_a[3];
  Lanes<T> half_b[3];
  /// The rotation from b's axes to a's: axis j of b is the column turn[0..2][j].
  Lanes<T> turn[3][3];
  /// Center of b, in a's axes and in b's.
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
    // c is NaN if the orientation of a is invalid; this makes the scale NaN also for b.
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
  /// Separation times the length of the axis, which is a cross product and at most 1 long.
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
  /// Square of the length of the cross product.
  [[gnu::always_inline]] Lanes<T> sine_square(int i, int j) const {
    const Lanes<T>& k = turn[(i + 1) % 3][j];
    const Lanes<T>& l = turn[(i + 2) % 3][j];
    return k * k + l * l;
  }
  /// Upper bound of the half extent of edge j of b perpendicular to axis i of a.
  [[gnu::always_inline]] Lanes<T> reach_across(int i, int j) const {
    return half_b[j] * (abs(turn[(i + 1) % 3][j]) + abs(turn[(i + 2) % 3][j]));
  }
  /// Separation along any unit vector from a to b, in the frame of a.
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

/// The axis with the largest separation.
template <typename T>
struct BoxAxis {
  /// Unit, from a to b, in the frame of a.
  Lanes<T> normal[3];
  Lanes<T> separation;
  /// Upper bound of the separations along all fifteen axes; if the cores overlap, along any unit
  /// vector.
  Lanes<T> most;
  Lanes<T> index;
  /// Square of the length of the axis before it was normalized; 1 for faces.
  Lanes<T> length2;
};

/// The largest separations along face normals and along cross products. Cross products are not
/// normalized, so the value for them is only correct in its sign, and only if no edges are
/// parallel.
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

/// As largest_edge_separation, without the cross products of parallel edges, whose signs are
/// unreliable. `left_out` receives the value that `offer_edges` returns.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> largest_crossed_separation(const BoxPair<T>& pair,
                                                                  Lanes<T>& left_out) {
  Lanes<T> s = -pair.scale;
  left_out = Lanes<T>(T(0));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const LaneMask<T> crossed = pair.sine_square(i, j) > Lanes<T>(kParallelSquare<T>);
      s = max(s, select(crossed, pair.edges(i, j), s));
      left_out = max(left_out, select(crossed, left_out, pair.reach_across(i, j)));
    }
  }
  return s;
}

/// The axis with the given number, with either sign.
template <typename T>
[[gnu::always_inline]] inline void axis_of(const BoxPair<T>& pair, const Lanes<T>& index,
                                           Lanes<T> (&axis)[3]) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const LaneMask<T> face_of_a = index < Lanes<T>(T(2.5));
  const LaneMask<T> product = index > Lanes<T>(T(5.5));
  const Lanes<T> k = select(product, index - Lanes<T>(T(6)), index);
  // For a cross product, k = 3 i + j for axis i of a and axis j of b. For a face, j is its axis.
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
  // The cross product of axis i of a and b: two components of b, one of them negated.
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

/// Offers the nine cross products except those of parallel edges. Seen along an edge of a that is
/// nearly parallel to edge j of b, box a is a rectangle. Box b is a parallelogram that is swept
/// along the projection of edge j, which is short. The side normals of the rectangle and of the
/// parallelogram are among the other axes. So if no other axis separates the boxes, the separation
/// along the left-out axis exceeds the largest of the others by at most the half extent of the
/// projection (reach_across). Returns the largest of these half extents.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> offer_edges(const BoxPair<T>& pair, const Lanes<T>& slack,
                                                   BestAxis<T>& best) {
  Lanes<T> least = pair.sine_square(0, 0);
  for (int k = 1; k < 9; ++k) least = min(least, pair.sine_square(k / 3, k % 3));
  const Lanes<T> parallel(kParallelSquare<T>);
  Lanes<T> left_out(T(0));
  if (bits(least > parallel) == kAllLanes<T>) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        best.offer(pair.edges(i, j) + slack, pair.sine_square(i, j), 6 + 3 * i + j);
      }
    }
    return left_out;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Lanes<T> length2 = pair.sine_square(i, j);
      const LaneMask<T> crossed = length2 > parallel;
      left_out = max(left_out, select(crossed, Lanes<T>(T(0)), pair.reach_across(i, j)));
      best.offer(select(crossed, pair.edges(i, j) + slack, -pair.scale),
                 select(crossed, length2, Lanes<T>(T(1))), 6 + 3 * i + j);
    }
  }
  return left_out;
}

template <typename T>
WINNOW_SHARED_BY_LEVELS BoxAxis<T> best_axis(const BoxPair<T>& pair) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kFlatSlack<T>);
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

/// The points of the boxes that are closest along an axis: the vertices that are farthest along it,
/// or, if the axis is a cross product, points of its two edges. `a` is in a's frame, `b` in b's.
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

/// If the axis is a cross product: replaces the vertices by the closest points of the edges through
/// them.
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
  // w is from the middle of a's edge to the middle of b's; along_a and along_b are its components
  // along the edges.
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
    reach.a[r] = select(is_i[r], clamp_to(s, pair.half_a[r]), reach.a[r]);
    reach.b[r] = select(is_j[r], clamp_to(t, pair.half_b[r]), reach.b[r]);
  }
}

/// The vertex center +- arm[0] +- arm[1] +- arm[2] that is closest to a box centered at the origin.
template <typename T>
struct NearestVertex {
  Lanes<T> square;
  Lanes<T> sign[3];

  [[gnu::always_inline]] NearestVertex(const Lanes<T> (&center)[3], const Lanes<T> (&arm)[3][3],
                                       const Lanes<T> (&half)[3]) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    square = Lanes<T>(T(kBeyondSquares));
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
WINNOW_SHARED_BY_LEVELS BoxPoints<T> closest_points(const BoxPair<T>& pair, const BoxAxis<T>& axis,
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

  // Either a vertex of a and the nearest point of b, or a vertex of b and the nearest point of a.
  Lanes<T> vertex_a[3];
  Lanes<T> next_to_a[3];
  for (int r = 0; r < 3; ++r) vertex_a[r] = of_a.sign[r] * pair.half_a[r];
  to_b(pair, vertex_a, next_to_a);
  Lanes<T> b[3];
  for (int j = 0; j < 3; ++j) {
    b[j] = select(
        by_edges, reach.b[j],
        select(vertex_of_b, of_b.sign[j] * pair.half_b[j], clamp_to(next_to_a[j], pair.half_b[j])));
  }
  BoxPoints<T> points;
  from_b(pair, b, points.b);
  for (int r = 0; r < 3; ++r) {
    points.a[r] = select(by_edges, reach.a[r],
                         select(vertex_of_b, clamp_to(points.b[r], pair.half_a[r]), vertex_a[r]));
  }
  return points;
}

}  // namespace winnow::WINNOW_ISA_NAME::flat
