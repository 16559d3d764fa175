// Half-spaces against hulls: the lowest vertex over the plane and, for contacts, the face or edge
// at it that faces the plane.

#include "pipeline/kernels/cores/hull_core.wide.h"
#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/half_space_common.wide.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"
#include "simd/lanes/rows.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

using hull::kNoFeature;

/// Vertices of a hull that may touch a plane: the lowest vertex, and the vertices of the face or
/// edge at it that faces the plane, if they are at most `reach` higher. If the face has more than
/// four corners, corners_on_plane chooses; vertex 0 may then be higher than the lowest one, by less
/// than kTiedDepth of the face's extent.
class HullPointsOnPlane {
 public:
  static constexpr std::uint32_t kMaxPoints = kManifoldPoints;

  HullPointsOnPlane(const HullShape& shape, const double* up, std::uint32_t lowest, double reach)
      : shape_(shape), up_(up) {
    add(lowest);
    double bottom[3];
    hull::vertex_at(shape, lowest, bottom);
    limit_ = dot3(up, bottom) + reach;
    const double down[3] = {-up[0], -up[1], -up[2]};
    float x[3];
    hull::vertex_at(shape, lowest, x);
    const float doubt = hull::kFloatError * static_cast<float>(hull::reach_of(shape));
    const std::uint32_t face = hull::face_across(shape, down, x, doubt);
    if (face != kNoFeature) {
      take_face(shape.faces[face]);
    } else {
      const float direction[3] = {static_cast<float>(down[0]), static_cast<float>(down[1]),
                                  static_cast<float>(down[2])};
      const std::uint32_t other = hull::neighbour_across(shape, direction, lowest, x);
      if (other != kNoFeature) add_within(other);
    }
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] std::uint32_t vertex(std::uint32_t i) const { return vertex_[i]; }

 private:
  static constexpr std::uint32_t kRoom = kPatchRoom;

  void add(std::uint32_t vertex) { vertex_[count_++] = vertex; }
  void add_within(std::uint32_t vertex) {
    double x[3];
    hull::vertex_at(shape_, vertex, x);
    if (dot3(up_, x) <= limit_) add(vertex);
  }

  void take_face(const HullFace& face) {
    if (face.count > kMaxPoints) return take_widest(face);
    for (std::uint32_t i = 0; i < face.count; ++i) {
      const std::uint32_t vertex = shape_.loop[face.first + i];
      if (vertex != vertex_[0]) add_within(vertex);
    }
  }

  void take_widest(const HullFace& face) {
    double point[kRoom][3];
    std::uint32_t edge[kRoom];
    std::uint32_t vertex[kRoom];
    // If the polygon has too many corners, take every second (third, ...) one.
    const std::uint32_t stride = (face.count + kRoom - 1) / kRoom;
    std::uint32_t size = 0;
    for (std::uint32_t i = 0; i < face.count; i += stride) {
      vertex[size] = shape_.loop[face.first + i];
      edge[size] = shape_.loop_edge[face.first + i];
      hull::vertex_at(shape_, vertex[size], point[size]);
      ++size;
    }
    const SupportingFeature patch{point, vertex, edge, size, 0, 0.0};
    const std::uint32_t found = corners_on_plane(patch, up_, limit_, vertex_);
    if (found > 0) count_ = found;
  }

  const HullShape& shape_;
  const double* up_;
  double limit_ = 0.0;
  std::uint32_t count_ = 0;
  std::uint32_t vertex_[kMaxPoints + 1] = {};
};

/// The plane in the frames of the hulls, also stored lane by lane, and the roundings and reaches of
/// the hulls.
template <typename T>
struct PlaneUnderHull {
  PlacedPlane<T> plane;
  ScaledQuaternion<T> turn;
  Rotation<T> axes;
  Vec3<T> up;
  alignas(64) T normal[3][Lanes<T>::kCount];
  alignas(64) T rounding[Lanes<T>::kCount];
  alignas(64) T reach[Lanes<T>::kCount];  // bound on sums of coordinates

  [[gnu::always_inline]] PlaneUnderHull(const NarrowJob& job, const PairBlock<T>& block)
      : plane(load_plane<SideB>(job, block)),
        turn(load_turn<SideA>(job, block)),
        axes(rotation(turn)),
        up(axes.to_local(plane.normal)) {
    up.x.store(normal[0]);
    up.y.store(normal[1]);
    up.z.store(normal[2]);
  }

  /// Reads and returns the hull of a lane. Call it for every lane.
  [[gnu::always_inline]] const HullShape& take(const NarrowJob& job, const PairBlock<T>& block,
                                               std::uint32_t lane) {
    const HullShape& shape =
        job.tables->hulls[shape_index<SideA>(job, block, static_cast<int>(lane))];
    rounding[lane] = static_cast<T>(shape.rounding);
    reach[lane] = T(2) * static_cast<T>(hull::reach_of(shape));
    return shape;
  }

  /// Sets the members that all feet share.
  template <int Count>
  [[gnu::always_inline]] void set_common(LowestPoints<T, Count>& feet) const {
    feet.rounding = Lanes<T>::load(rounding);
    feet.normal = plane.normal;
    feet.scale = plane.scale + feet.rounding + Lanes<T>::load(reach) + doubt(turn);
  }
};

struct HullOverPlane {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    if constexpr (L == kManifold) {
      return LowestPointAnswers<4>::write<L>(job, block, feet<T, 4>(job, block));
    } else if constexpr (L == kBoolean && sizeof(T) == sizeof(float)) {
      return LowestPointAnswers<1>::write<L>(job, block, heights(job, block));
    } else {
      return LowestPointAnswers<1>::write<L>(job, block, feet<T, 1>(job, block));
    }
  }

  /// Computes only the heights of the lowest vertices.
  [[gnu::noinline]] static LowestPoints<float, 1> heights(const NarrowJob& job,
                                                          const PairBlock<float>& block) {
    PlaneUnderHull<float> under(job, block);
    alignas(64) float low[kLanes][kLanes];
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      const HullShape& shape = under.take(job, block, lane);
      const Vec3<float> n{under.normal[0][lane], under.normal[1][lane], under.normal[2][lane]};
      Floats least = hull::along(shape.vertex_float, 0, n);
      for (std::uint32_t row = kLanes; row < shape.vertex_count; row += kLanes) {
        least = min(least, hull::along(shape.vertex_float, row, n));
      }
      least.store(low[lane]);
    }
    LowestPoints<float, 1> r;
    r.height[0] = under.plane.height + reduce_min_rows(low[0]);
    under.set_common(r);
    return r;
  }

  template <typename T, int Count>
  [[gnu::noinline]] static LowestPoints<T, Count> feet(const NarrowJob& job,
                                                       const PairBlock<T>& block) {
    constexpr std::uint32_t kWidth = Lanes<T>::kCount;
    PlaneUnderHull<T> under(job, block);
    const PlacedPlane<T>& plane = under.plane;
    const auto& normal = under.normal;
    alignas(64) T height[kWidth];
    plane.height.store(height);
    // The last entry is the lowest vertex, whose height the first foot gets.
    alignas(64) T vertex[Count + 1][3][kWidth];
    alignas(64) T name[Count + 1][kWidth];
    alignas(64) T missing[Count][kWidth] = {};
    for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
      const HullShape& shape = under.take(job, block, lane);
      const Vec3<typename RealOf<T>::Type> down{-normal[0][lane], -normal[1][lane],
                                                -normal[2][lane]};
      const std::uint32_t lowest = hull::highest_vertex(shape, down);
      hull_vertex(shape, lowest, Count, lane, vertex, name);
      if constexpr (Count == 1) {
        hull_vertex(shape, lowest, 0, lane, vertex, name);
      } else {
        const double d[3] = {static_cast<double>(normal[0][lane]),
                             static_cast<double>(normal[1][lane]),
                             static_cast<double>(normal[2][lane])};
        double x[3];
        hull::vertex_at(shape, lowest, x);
        const double room = job.margin_of(block.first + lane) + shape.rounding -
                            (dot3(d, x) + static_cast<double>(height[lane]));
        std::uint32_t found = 1;
        hull_vertex(shape, lowest, 0, lane, vertex, name);
        if (room >= 0.0) {
          const HullPointsOnPlane print(shape, d, lowest, room);
          found = print.count();
          for (std::uint32_t i = 0; i < found; ++i) {
            hull_vertex(shape, print.vertex(i), i, lane, vertex, name);
          }
        }
        for (std::uint32_t i = found; i < Count; ++i) {
          hull_vertex(shape, lowest, i, lane, vertex, name);
          missing[i][lane] = kLargest<T>;
        }
      }
    }
    LowestPoints<T, Count> r;
    for (int i = 0; i < Count; ++i) {
      const Vec3<T> local{Lanes<T>::load(vertex[i][0]), Lanes<T>::load(vertex[i][1]),
                          Lanes<T>::load(vertex[i][2])};
      const auto& high = vertex[i == 0 ? Count : i];
      const Vec3<T> level{Lanes<T>::load(high[0]), Lanes<T>::load(high[1]),
                          Lanes<T>::load(high[2])};
      const Lanes<T> gone = Lanes<T>::load(missing[i]);
      r.foot[i] = under.axes.to_world(local);
      r.height[i] = select(gone > Lanes<T>(T(0)), gone, plane.height + dot(under.up, level));
      r.feature[i] = Lanes<T>::load(name[i]);
    }
    under.set_common(r);
    return r;
  }

  template <typename T, std::size_t Count, std::size_t Width>
  [[gnu::always_inline]] static void hull_vertex(const HullShape& shape, std::uint32_t vertex,
                                                 std::uint32_t i, std::uint32_t lane,
                                                 T (&to)[Count][3][Width],
                                                 T (&name)[Count][Width]) {
    const auto* const* column = hull::columns_of(shape, typename RealOf<T>::Type());
    for (int k = 0; k < 3; ++k) to[i][k][lane] = column[k][vertex];
    name[i][lane] = static_cast<T>(vertex);
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(hull_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::HullOverPlane>();

}  // namespace winnow
