#pragma once

// Support points for sixteen pairs of hulls, one pair per lane: the vertex of the first that is
// farthest against a direction, and the point of the second farthest along it. Hulls are processed
// one after the other, sixteen vertices at a time; the few vertices of simple shapes are processed
// in all lanes at once. Used by hull_search.wide.h and overlap_test.wide.h.

#include "pipeline/kernels/hull/hull_pair.wide.h"
#include "simd/lanes/rows.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// The number of a vertex as the bit pattern of a lane.
constexpr float number_pattern(std::uint32_t number) {
  return __builtin_bit_cast(float, number);
}
/// The second's vertex number is stored above the first's.
constexpr float second_pattern(std::uint32_t number) {
  return number_pattern(number << 16U);
}

/// One row per lane: the heights of the hull's sixteen vertices. If the hull has more, entry i is
/// the largest height of the vertices i, i + 16, ..., and `block` stores from which block of
/// sixteen it is.
struct VertexHeights {
  alignas(64) float height[kLanes * kLanes];
  alignas(64) float block[kLanes * kLanes];
};

/// Calls found(lane, vertex) for all `active` lanes with the vertex of hull[lane] that is farthest
/// along the lane's direction, in float and in the hull's own frame.
template <typename Found>
[[gnu::always_inline]] static inline void for_farthest_vertices(const HullShape* const* hull,
                                                                const Vec3<float>& direction,
                                                                Mask16 active, VertexHeights& rows,
                                                                Found&& found) {
  alignas(64) float along[3][kLanes];
  direction.x.store(along[0]);
  direction.y.store(along[1]);
  direction.z.store(along[2]);
  for (Mask16 rest = active; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    const float d[3] = {along[0][lane], along[1][lane], along[2][lane]};
    heights(*hull[lane], d, rows.height + lane * kLanes, rows.block + lane * kLanes);
  }
  alignas(64) float highest[kLanes];
  reduce_max_rows(rows.height).store_unaligned(highest);
  for (Mask16 rest = active; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    found(lane, vertex_of(*hull[lane], highest[lane], rows.height + lane * kLanes,
                          rows.block + lane * kLanes));
  }
}

/// Returns the vertices that for_farthest_vertices finds; 0 in the other lanes.
[[gnu::noinline]] static Vec3<float> farthest_vertices(const HullShape* const* hull,
                                                       const Vec3<float>& direction, Mask16 active,
                                                       VertexHeights& rows) {
  alignas(64) float x[3][kLanes] = {};
  for_farthest_vertices(hull, direction, active, rows, [&](unsigned lane, std::uint32_t vertex) {
    for (int i = 0; i < 3; ++i) x[i][lane] = hull[lane]->vertex_float[i][vertex];
  });
  return {Floats::load(x[0]), Floats::load(x[1]), Floats::load(x[2])};
}

/// The supporting vertices of the hulls in the lanes, and their numbers.
class FarthestVertices {
 public:
  void put(int lane, const HullShape& hull) { hull_[lane] = &hull; }

  void find(const Vec3<float>& direction, Mask16 active) {
    for_farthest_vertices(hull_, direction, active, rows_,
                          [&](unsigned lane, std::uint32_t vertex) {
                            number_[lane] = vertex;
                            for (int i = 0; i < 3; ++i) {
                              vertex_[i][lane] = hull_[lane]->vertex_float[i][vertex];
                            }
                          });
  }

  [[nodiscard]] Vec3<float> vertex() const {
    return {Floats::load(vertex_[0]), Floats::load(vertex_[1]), Floats::load(vertex_[2])};
  }
  /// The numbers times 2^shift.
  [[nodiscard]] Floats numbers(std::uint32_t shift) const {
    alignas(64) float pattern[kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      pattern[lane] = number_pattern(number_[lane] << shift);
    return Floats::load(pattern);
  }

 private:
  const HullShape* hull_[kLanes] = {};
  std::uint32_t number_[kLanes] = {};
  alignas(64) float vertex_[3][kLanes] = {};
  VertexHeights rows_;
};

/// The second's point that is farthest along a direction, in the first's frame and scaled, and its
/// number.
struct SecondSupport {
  Vec3<float> point;
  Floats number;
};

/// Second hulls as stored in the pool.
class HullSeconds {
 public:
  void put(int lane, const HullPair& pair) {
    vertices_.put(lane, *pair.second);
    for (int i = 0; i < 9; ++i) turn_[i][lane] = pair.scaled_turn[i];
    for (int i = 0; i < 3; ++i) shift_[i][lane] = pair.scaled_shift[i];
  }

  SecondSupport find(const Vec3<float>& d, Mask16 active) {
    Floats t[9];
    for (int i = 0; i < 9; ++i) t[i] = Floats::load(turn_[i]);
    const auto turned_back = [&](int i) { return t[i] * d.x + t[3 + i] * d.y + t[6 + i] * d.z; };
    vertices_.find({turned_back(0), turned_back(1), turned_back(2)}, active);
    const Vec3<float> v = vertices_.vertex();
    const auto placed = [&](int i) {
      return t[3 * i] * v.x + t[3 * i + 1] * v.y + t[3 * i + 2] * v.z + Floats::load(shift_[i]);
    };
    return {{placed(0), placed(1), placed(2)}, vertices_.numbers(16)};
  }

 private:
  FarthestVertices vertices_;
  alignas(64) float turn_[9][kLanes] = {};
  alignas(64) float shift_[3][kLanes] = {};
};

/// Cores of spheres, capsules and boxes: a center and `Axes` half axes. Bit k of a vertex's number
/// is set if it is at the positive end of half axis k.
template <int Axes>
class CenteredSeconds {
 public:
  void put(int lane, const HullPair& pair) {
    for (int i = 0; i < 3; ++i) middle_[i][lane] = pair.scaled_shift[i];
    for (int k = 0; k < Axes; ++k) {
      // A segment runs along z.
      const int along = Axes == 1 ? 2 : k;
      const float half = pair.second->vertex_float[along][(1U << Axes) - 1];
      for (int i = 0; i < 3; ++i) arm_[k][i][lane] = pair.scaled_turn[3 * i + along] * half;
    }
  }

  [[nodiscard]] SecondSupport find(const Vec3<float>& d, Mask16 /*active*/) const {
    const Floats zero(0.0F);
    SecondSupport r{{Floats::load(middle_[0]), Floats::load(middle_[1]), Floats::load(middle_[2])},
                    zero};
    for (int k = 0; k < Axes; ++k) {
      const Vec3<float> arm{Floats::load(arm_[k][0]), Floats::load(arm_[k][1]),
                            Floats::load(arm_[k][2])};
      const LaneMask<float> far = dot(arm, d) > zero;
      r.point = r.point + select(far, arm, -arm);
      r.number = r.number | select(far, Floats(second_pattern(1U << k)), zero);
    }
    return r;
  }

 private:
  alignas(64) float middle_[3][kLanes] = {};
  alignas(64) float arm_[Axes > 0 ? Axes : 1][3][kLanes] = {};
};

class TriangleSeconds {
 public:
  void put(int lane, const HullPair& pair) {
    const float* const* vertex = pair.second->vertex_float;
    for (int v = 0; v < 3; ++v) {
      const float x[3] = {vertex[0][v], vertex[1][v], vertex[2][v]};
      float placed[3];
      turn3(pair.scaled_turn, x, placed);
      for (int i = 0; i < 3; ++i) corner_[v][i][lane] = placed[i] + pair.scaled_shift[i];
    }
  }

  [[nodiscard]] SecondSupport find(const Vec3<float>& d, Mask16 /*active*/) const {
    SecondSupport r{corner(0), Floats(0.0F)};
    Floats highest = dot(r.point, d);
    for (int v = 1; v < 3; ++v) {
      const Vec3<float> other = corner(v);
      const Floats height = dot(other, d);
      const LaneMask<float> higher = height > highest;
      highest = select(higher, height, highest);
      r.point = select(higher, other, r.point);
      r.number = select(higher, Floats(second_pattern(static_cast<std::uint32_t>(v))), r.number);
    }
    return r;
  }

 private:
  [[nodiscard]] Vec3<float> corner(int v) const {
    return {Floats::load(corner_[v][0]), Floats::load(corner_[v][1]), Floats::load(corner_[v][2])};
  }

  alignas(64) float corner_[3][3][kLanes] = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
