#pragma once

// Projects the faces of boxes and triangles along the contact normal, eight pairs at a time in
// double. The results are bit-identical to those that flat_box_feature, flat_triangle_feature,
// PatchFrame and Outline compute for one pair. Called by the flat kernels through flat.wide.h.

#include "pipeline/kernels/pair_lanes.wide.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow::WINNOW_ISA_NAME::flat {

using Doubles3 = Vec3<double>;

/// Vectors and numbers of all lanes in memory, so that single lanes can be read.
template <typename T, int Count>
struct Stage {
  alignas(64) T value[Count][Lanes<T>::kCount];

  [[nodiscard, gnu::always_inline]] Lanes<T> number(int at) const {
    return Lanes<T>::load(value[at]);
  }
  [[nodiscard, gnu::always_inline]] Vec3<T> vector(int at) const {
    return {number(at), number(at + 1), number(at + 2)};
  }
  [[gnu::always_inline]] void put(int at, const Lanes<T>& v) { v.store(value[at]); }
  [[gnu::always_inline]] void put(int at, const Vec3<T>& v) {
    put(at, v.x);
    put(at + 1, v.y);
    put(at + 2, v.z);
  }
  [[gnu::always_inline]] void put(int at, const Rotation<T>& axes) {
    put(at, axes.x);
    put(at + 3, axes.y);
    put(at + 6, axes.z);
  }
  [[gnu::always_inline]] void get(int at, int count, unsigned lane, double* out) const {
    for (int i = 0; i < count; ++i) out[i] = value[at + i][lane];
  }
};

/// The corners of a face in order around it.
template <int Corners>
struct FaceCorners {
  Doubles3 corner[Corners];
  Lanes<double> number;
};

/// The face of a box that is most perpendicular to `normal`, on the side of the normal: see
/// flat_box_feature.
[[gnu::always_inline]] inline FaceCorners<4> face_of_box(const Doubles3 (&axis)[3],
                                                         const Doubles3& half,
                                                         const Doubles3& center,
                                                         const Doubles3& normal) {
  const Lanes<double> rise[3] = {dot(axis[0], normal), dot(axis[1], normal), dot(axis[2], normal)};
  const LaneMask<double> beats_0 = abs(rise[1]) > abs(rise[0]);
  const Lanes<double> better = select(beats_0, rise[1], rise[0]);
  const LaneMask<double> is_2 = abs(rise[2]) > abs(better);
  const LaneMask<double> is_0 = !(beats_0 | is_2);
  const LaneMask<double> is_1 = beats_0 & !is_2;
  const Lanes<double> half_of[3] = {half.x, half.y, half.z};
  // The axis, or half extent, whose number is the number of the face's axis plus `turn`, modulo 3.
  const auto axis_after = [&](int turn) __attribute__((always_inline)) {
    return select(is_0, axis[turn], select(is_1, axis[(1 + turn) % 3], axis[(2 + turn) % 3]));
  };
  const auto half_after = [&](int turn) __attribute__((always_inline)) {
    return select(is_0, half_of[turn],
                  select(is_1, half_of[(1 + turn) % 3], half_of[(2 + turn) % 3]));
  };
  const LaneMask<double> up = select(is_2, rise[2], better) > Lanes<double>(0.0);
  const Lanes<double> half_i = half_after(0);
  const Lanes<double> half_k = half_after(1);
  const Lanes<double> half_l = half_after(2);
  const Doubles3 arm_i = axis_after(0) * select(up, half_i, -half_i);
  const Doubles3 axis_k = axis_after(1);
  const Doubles3 axis_l = axis_after(2);
  const Doubles3 arm_k[2] = {axis_k * -half_k, axis_k * half_k};
  const Doubles3 arm_l[2] = {axis_l * -half_l, axis_l * half_l};
  FaceCorners<4> face;
  face.corner[0] = center + (arm_i + (arm_k[0] + arm_l[0]));
  face.corner[1] = center + (arm_i + (arm_k[1] + arm_l[0]));
  face.corner[2] = center + (arm_i + (arm_k[1] + arm_l[1]));
  face.corner[3] = center + (arm_i + (arm_k[0] + arm_l[1]));
  const Lanes<double> zero(0.0);
  face.number = select(is_0, zero, select(is_1, Lanes<double>(2.0), Lanes<double>(4.0))) +
                select(up, Lanes<double>(1.0), zero);
  return face;
}

[[gnu::always_inline]] inline FaceCorners<3> face_of_triangle(const Doubles3& a, const Doubles3& b,
                                                              const Doubles3& c) {
  return {{a, b, c}, Lanes<double>(static_cast<double>(kTriangleFace))};
}

/// Both faces of eight pairs.
class ProjectedPairs {
 public:
  /// Sets the projection axes for a normal: see PatchFrame.
  [[gnu::always_inline]] void set_projection(const Doubles3& n) {
    const Lanes<double> one(1.0);
    const Lanes<double> sign = (n.z & Lanes<double>(-0.0)) | one;
    const Lanes<double> a = Lanes<double>(-1.0) / (sign + n.z);
    const Lanes<double> b = n.x * n.y * a;
    rows_.put(kAxisX, Doubles3{one + sign * n.x * n.x * a, sign * b, -sign * n.x});
    rows_.put(kAxisY, Doubles3{b, sign + n.y * n.y * a, -n.y});
    rows_.put(kAxisZ, n);
    plain_ = ~Mask16{0};
  }

  /// Projects the face of one side, 0 or 1.
  template <int Corners>
  [[gnu::always_inline]] void see(const FaceCorners<Corners>& face, int side) {
    const Doubles3 x = rows_.vector(kAxisX);
    const Doubles3 y = rows_.vector(kAxisY);
    const Doubles3 z = rows_.vector(kAxisZ);
    const int to = static_cast<int>(ProjectedFaces::kFaces) + side * ProjectedFaces::kFaceRows;
    Doubles3 seen[Corners];
    for (int i = 0; i < Corners; ++i) {
      const Doubles3& p = face.corner[i];
      seen[i] = {dot(x, p), dot(y, p), dot(z, p)};
      rows_.put(to + ProjectedFaces::kX + i, seen[i].x);
      rows_.put(to + ProjectedFaces::kY + i, seen[i].y);
      rows_.put(to + ProjectedFaces::kH + i, seen[i].z);
    }
    Doubles3 low = seen[0];
    Doubles3 high = seen[0];
    for (int i = 1; i < Corners; ++i) {
      low = {min(low.x, seen[i].x), min(low.y, seen[i].y), low.z};
      high = {max(high.x, seen[i].x), max(high.y, seen[i].y), high.z};
    }
    const Lanes<double> size = max(high.x - low.x, high.y - low.y);
    const Lanes<double> zero(0.0);
    Doubles3 normal{zero, zero, zero};
    for (int i = 1; i + 1 < Corners; ++i) {
      normal = normal + cross(seen[i] - seen[0], seen[i + 1] - seen[0]);
    }
    const Lanes<double> area = abs(normal.z);
    const Lanes<double> length = sqrt(dot(normal, normal));
    rows_.put(to + ProjectedFaces::kSize, size);
    rows_.put(to + ProjectedFaces::kSlope, -normal.x / normal.z);
    rows_.put(to + ProjectedFaces::kSlope + 1, -normal.y / normal.z);
    rows_.put(to + ProjectedFaces::kCosine, area / length);
    face.number.store(number_[side]);
    clockwise_[side] = bits(normal.z < zero);
    plain_ &=
        bits((area > Lanes<double>(kThin) * size * size) & (area > Lanes<double>(kSteep) * length));
  }

  /// False for a lane with a thin or steep face. The contacts of such a lane need flat_contacts.
  [[nodiscard]] bool is_plain(unsigned lane) const { return (plain_ >> lane & 1U) != 0; }
  [[nodiscard]] ProjectedFaces faces(unsigned lane, double rounding_a, double rounding_b) const {
    const auto number = [&](int side) { return static_cast<std::uint32_t>(number_[side][lane]); };
    const auto turned = [&](int side) { return (clockwise_[side] >> lane & 1U) != 0; };
    return {&rows_.value[0][lane],
            {number(0), number(1)},
            {turned(0), turned(1)},
            {rounding_a, rounding_b}};
  }

 private:
  // Rows of the axes.
  enum AxisRow { kAxisX = 0, kAxisY = 3, kAxisZ = 6 };

  static_assert(Doubles::kCount == ProjectedFaces::kStride);

  Stage<double, ProjectedFaces::kRows> rows_;
  alignas(64) double number_[2][ProjectedFaces::kStride];
  Mask16 plain_ = 0;
  Mask16 clockwise_[2] = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::flat
