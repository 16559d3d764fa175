// Rays against meshes, height fields and compounds: the closest hit of each ray (mid::cast_rays).
// Rays are transformed to the frame of a surface; the surface and its triangles are not
// transformed. Kernels of pipeline/mesh find the triangles that rays certainly hit. Triangles for
// which rounding errors decide, and convex children, are tested as convex shapes (`enters`).

#include "pipeline/composites/composites.h"
#include "pipeline/composites/parts.h"
#include "pipeline/composites/transformed_shape.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_rays.kernel.h"
#include "pipeline/shapes/two_diff.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace winnow::mid {
namespace {

/// Transforms a normal of extreme length from the frame of the surface to the world, and normalises
/// it.
[[nodiscard]] Vec unit_under(const SurfaceFrame& frame, const Vec& normal) noexcept {
  const Eigen::Map<const Mat> transposed(frame.world_to_local[0]);
  const Vec of = normal.stableNormalized();
  return Vec(transposed.col(0).dot(of), transposed.col(1).dot(of), transposed.col(2).dot(of))
      .stableNormalized();
}

/// Returns the power of two that scales a positive x into [1/2, 1).
[[nodiscard]] double scale_to_one(double x) noexcept {
  constexpr std::uint64_t kMaxExponent = 2045;
  const std::uint64_t exponent = std::bit_cast<std::uint64_t>(x) >> 52;
  if (exponent != 0 && exponent < kMaxExponent) {
    return std::bit_cast<double>((kMaxExponent - exponent) << 52);
  }
  int power = 0;
  std::frexp(x, &power);
  return std::ldexp(1.0, -power);
}

/// Returns a - b + t * d with compensated sums.
[[nodiscard]] double moved_from(double a, double b, double t, double d) noexcept {
  const double between = a - b;
  const double back = between - a;
  return moved(between, (a - (between - back)) + (-b - back), t, d);
}

/// A body and a ray, both relative to `about`. The rounding error of the ray's origin is subtracted
/// from the position of the body.
struct NearBody {
  NearBody(const TransformedShape& placed, const Vec& about, const ShapeRay& of) noexcept
      : ray(of), body(placed) {
    const TwoDiff between = difference(of.origin.data(), about.data());
    ray.origin = between.difference;
    body.position = (placed.position - about) - Vec::Map(between.rest);
  }

  ShapeRay ray;
  TransformedShape body;
};

/// Transforms a vector to the frame of the surface; sums in the order of the columns.
void turn_into(const SurfaceFrame& frame, const Vec3d& v, double (&turned)[3]) noexcept {
  const auto& column = frame.world_to_local;
  for (int i = 0; i < 3; ++i) {
    turned[i] = column[0][i] * v[0] + column[1][i] * v[1] + column[2][i] * v[2];
  }
}
/// Upper bound on the coordinates of the transformed vector, for any signs of `v`.
[[nodiscard]] double largest_turned(const SurfaceFrame& frame, const Vec3d& v) noexcept {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto part = [&](int k) { return std::abs(frame.world_to_local[k][i]) * std::abs(v[k]); };
    largest = std::max(largest, part(0) + part(1) + part(2));
  }
  return largest;
}
[[nodiscard]] double largest_of(const Vec3d& v) noexcept {
  return std::max(std::max(std::abs(v[0]), std::abs(v[1])), std::abs(v[2]));
}

/// Transforms one ray to the frame of a surface, like the kernel for eight rays. If the ray starts
/// far away, its origin is moved along the ray close to the surface. Returns false if its numbers
/// are too large or too small.
template <std::uint32_t Room>
[[nodiscard]] bool place_ray(const SurfaceFrame& frame, const ShapeRay& ray, std::uint32_t lane,
                             SurfaceRayColumns<Room>& own) noexcept {
  double start[3];
  for (int i = 0; i < 3; ++i) start[i] = ray.origin[i] - frame.position[i];
  const double fastest = largest_of(ray.direction);
  if (!(largest_of(start) < kMaxRayLength && frame.size < kMaxRayLength &&
        fastest < kMaxRayLength && fastest > 1.0 / kMaxRayLength)) {
    return false;
  }
  // The closest approach to the surface's origin is at t = towards / square.
  const Vec3d direction(ray.direction);
  const double towards = -direction.dot(Vec3d(start));
  const double square = direction.squared_norm();
  double shift = 0.0;
  if (towards > kFarSizes * frame.size * (square / fastest)) [[unlikely]] {
    shift = std::max(0.0, towards / square - kFarSizes * frame.size / fastest);
    for (int i = 0; i < 3; ++i) {
      start[i] = moved_from(ray.origin[i], frame.position[i], shift, ray.direction[i]);
    }
  }
  double way[3];
  double from[3];
  double coordinate = 0.0;
  if (frame.is_rotated) {
    turn_into(frame, ray.direction, way);
    turn_into(frame, start, from);
    coordinate = largest_turned(frame, start);
  } else {
    std::copy_n(ray.direction.data(), 3, way);
    std::copy_n(start, 3, from);
    coordinate = largest_of(start);
  }
  const double t_scale = scale_to_one(frame.is_rotated ? largest_of(way) : fastest);
  for (int axis = 0; axis < 3; ++axis) {
    own.ray.origin[axis][lane] = from[axis];
    own.ray.direction[axis][lane] = way[axis] * t_scale;
  }
  own.slack[lane] = kRaySlack * (coordinate + frame.reach);
  own.shift[lane] = shift;
  own.t_scale[lane] = t_scale;
  return true;
}

/// Compares the bits, so that -0 and 0 differ.
[[nodiscard]] bool is_same(const Pose& a, const Pose& b) noexcept {
  using Bits = std::array<std::uint64_t, sizeof(Pose) / sizeof(std::uint64_t)>;
  const auto of_a = std::bit_cast<Bits>(a);
  const auto of_b = std::bit_cast<Bits>(b);
  std::uint64_t differ = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) differ |= of_a[i] ^ of_b[i];
  return differ == 0;
}

/// Prepares a mesh or height field.
void prepare(const TransformedShape& body, RaySurface& surface) noexcept {
  const bool is_mesh = body.kind == TransformedShape::Kind::mesh;
  const Aabb bounds = is_mesh ? body.shared->mesh.bounds() : body.field->bounds();
  Vec corner;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    corner[static_cast<Eigen::Index>(axis)] =
        static_cast<double>(std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis])));
  }
  surface.mesh = body.mesh;
  surface.is_one_sided = body.front != 0;
  Vec::Map(surface.frame.position) = body.position;
  Mat::Map(surface.frame.world_to_local[0]) = body.to_local;
  surface.frame.is_rotated = body.to_local != Mat::Identity();
  surface.frame.reach = corner.maxCoeff();
  surface.frame.size = (body.to_world.cwiseAbs() * corner).sum();
}

/// The closest hit of a ray so far, among primitives that are tested as convex shapes. The ray and
/// the primitives are relative to the same point.
struct RayResult {
  const ShapePool& shapes;
  const ShapeRay& ray;
  bool any;
  double limit;
  PartHit& hit;

  /// Functions return the new limit.
  double add(const PartHit& found) noexcept {
    if (!(found.t <= limit)) return limit;
    if (!hit.found || found.t < hit.t || (found.t == hit.t && found.part < hit.part)) hit = found;
    return limit = any ? -1.0 : found.t;
  }
  double test(const Primitive& primitive) noexcept {
    ShapeHit entry;
    if (!enters(shapes, ray, part_of(primitive), entry)) return limit;
    return add(
        {true, true, primitive.part, entry.t, {entry.normal[0], entry.normal[1], entry.normal[2]}});
  }
};

/// Tests all primitives whose boxes the ray hits; for a compound that has surfaces, calls
/// `children` instead.
void test_all_on_ray(const NearBody& near, RayResult& result, const ChildVisitor& children) {
  // Relative growth of the ray's box before the box tests, which round coordinates.
  constexpr double kGrowth = 0x1p-47;
  const auto from = as_eigen(near.ray.origin);
  const double grow = kGrowth * from.cwiseAbs().maxCoeff();
  MovingBox moving_box;
  for (int i = 0; i < 3; ++i) {
    moving_box.min[i] = from[i] - grow;
    moving_box.max[i] = from[i] + grow;
    moving_box.direction[i] = near.ray.direction[i];
  }
  moving_box.max_t = near.ray.max_t;
  visit(near.body, moving_box,
        {[](void* context, const Primitive& primitive, double) {
           return static_cast<RayResult*>(context)->test(primitive);
         },
         &result},
        children);
}

/// A mesh or height field as the target of rays.
struct RayTarget {
  const Composites& all;
  const RaySurface& surface;
  /// The body, and the point that its primitives and rays are relative to when they are tested as
  /// convex shapes. Null if the surface was prepared by an earlier call; then `near` makes the
  /// body.
  const TransformedShape* body = nullptr;
  Vec about = Vec::Zero();

  [[nodiscard]] NearBody near(const ShapeRay& ray) const noexcept {
    if (body != nullptr) return {*body, about, ray};
    const TransformedShape made =
        TransformedShape::at(all, surface.shape, surface.pose, Solids::triangles);
    return {made, made.position, ray};
  }
};

/// Up to `Room` rays that are traced through a surface together.
template <std::uint32_t Room>
class RayPacket {
 public:
  /// `hits` has an entry for each ray, which `trace` improves.
  RayPacket(const RayTarget& target, std::span<const ShapeRay> rays, bool any,
            PartHit* hits) noexcept
      : target_(target), rays_(rays), hits_(hits) {
    closest_.any = any;
    closest_.is_one_sided = target.surface.is_one_sided;
    closest_.frame = &target.surface.frame;
    closest_.first_part = target.body != nullptr ? target.body->first_number : 0;
    closest_.test = [](void* context, std::uint32_t i, std::uint32_t slot, double limit) {
      return static_cast<RayPacket*>(context)->test(i, slot, limit);
    };
    closest_.context = this;
  }
  RayPacket(const RayPacket&) = delete;
  RayPacket& operator=(const RayPacket&) = delete;

  [[nodiscard]] bool is_full() const noexcept { return count_ == Room; }
  void add(std::size_t ray, double limit) noexcept;
  /// Traces the added rays.
  void trace();

 private:
  /// Transforms the rays to the frame of the surface. Returns one bit for each ray whose numbers
  /// are too large or too small for that.
  [[nodiscard]] std::uint64_t place() noexcept;
  /// Transforms the rays with the kernel. Returns one bit for each ray that is left to place_ray.
  [[nodiscard]] std::uint64_t place_by_kernel() noexcept;
  /// The kernel visits the triangles of a mesh, and calls `test` for the uncertain ones.
  void trace_mesh();
  /// A height field has no kernel for its cells: `height_cast` walks over them.
  void trace_field(std::uint32_t i);
  /// Tests a triangle as a convex shape. Returns the new limit in the caller's t.
  [[nodiscard]] double test(std::uint32_t i, std::uint32_t slot, double limit);
  /// Tests a triangle of a height field. Returns the new limit in own t.
  [[nodiscard]] double test_in_field(std::uint32_t i, std::uint32_t slot, double own_before);

  const RayTarget& target_;
  std::span<const ShapeRay> rays_;
  PartHit* hits_;
  std::uint32_t count_ = 0;
  /// Index of each ray in `rays_`.
  std::size_t number_[Room];
  RayColumns<Room> world_;
  SurfaceRayColumns<Room> own_;
  ClosestHits<Room> closest_;
};

template <std::uint32_t Room>
void RayPacket<Room>::add(std::size_t ray, double limit) noexcept {
  if constexpr (Room != 1) {
    const ShapeRay& world_ray = rays_[ray];
    for (int axis = 0; axis < 3; ++axis) {
      world_.origin[axis][count_] = world_ray.origin[axis];
      world_.direction[axis][count_] = world_ray.direction[axis];
    }
  }
  number_[count_] = ray;
  closest_.limit[count_] = limit;
  closest_.best[count_] = hits_ + ray;
  ++count_;
}

template <std::uint32_t Room>
std::uint64_t RayPacket<Room>::place_by_kernel() noexcept {
  if constexpr (Room == 1) {
    return 1;
  } else {
    const std::uint32_t rest = (kRayLanes - count_ % kRayLanes) % kRayLanes;
    const std::uint32_t last = count_ - 1;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(world_.origin[axis] + count_, rest, world_.origin[axis][last]);
      std::fill_n(world_.direction[axis] + count_, rest, world_.direction[axis][last]);
    }
    std::fill_n(closest_.own_limit + count_, rest, -1.0);
    return mesh_ray_kernels().place(target_.surface.frame, world_, count_, own_);
  }
}

template <std::uint32_t Room>
std::uint64_t RayPacket<Room>::place() noexcept {
  std::uint64_t unplaced = 0;
  if constexpr (Room == 1) {
    if (place_ray(target_.surface.frame, rays_[number_[0]], 0, own_)) [[likely]]
      return 0;
  }
  for (std::uint64_t left = place_by_kernel(); left != 0; left &= left - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
    if (place_ray(target_.surface.frame, rays_[number_[i]], i, own_)) continue;
    unplaced |= std::uint64_t{1} << i;
    own_.shift[i] = 0.0;
    own_.t_scale[i] = 1.0;
  }
  return unplaced;
}

template <std::uint32_t Room>
void RayPacket<Room>::trace() {
  if (count_ == 0) return;
  const std::uint32_t count = Room == 1 ? 1 : count_;
  // Rays that have no place in the frame of the surface are tested against all primitives, and then
  // have no limit left.
  for (std::uint64_t left = place(); left != 0; left &= left - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
    const NearBody near = target_.near(rays_[number_[i]]);
    RayResult result{target_.all.shapes, near.ray, closest_.any, closest_.limit[i],
                     hits_[number_[i]]};
    test_all_on_ray(near, result, {});
    closest_.limit[i] = -1.0;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    closest_.unit[i] = 1.0 / own_.t_scale[i];
    const LocalRayTime to_own = closest_.time(own_, i);
    const double limit = closest_.limit[i];
    closest_.own_limit[i] =
        limit >= 0.0 ? to_own.first_limit(limit, target_.surface.frame.reach) : -1.0;
    own_.low[i] = to_own(rays_[number_[i]].min_t);
    own_.high[i] = to_own(rays_[number_[i]].max_t);
  }
  if (target_.surface.mesh != nullptr) {
    trace_mesh();
  } else {
    for (std::uint32_t i = 0; i < count; ++i) trace_field(i);
  }
  // Finish the normals that `set_normal` leaves as they are, because their squares are no normal
  // numbers.
  for (std::uint32_t i = 0; i < count; ++i) {
    PartHit& hit = *closest_.best[i];
    if (hit.found && !hit.has_unit_normal) [[unlikely]] {
      Vec::Map(hit.normal) = unit_under(target_.surface.frame, Vec::Map(hit.normal));
      hit.has_unit_normal = true;
    }
  }
  count_ = 0;
}

template <std::uint32_t Room>
void RayPacket<Room>::trace_mesh() {
  const MeshView& mesh = *target_.surface.mesh;
  if constexpr (Room == 1) {
    mesh_ray_kernels().closest_of_one(mesh, own_, closest_);
  } else {
    mesh_ray_kernels().closest(mesh, own_, count_, closest_);
  }
}

template <std::uint32_t Room>
double RayPacket<Room>::test(std::uint32_t i, std::uint32_t slot, double limit) {
  Primitive primitive;
  const NearBody near = target_.near(rays_[number_[i]]);
  if (!near.body.primitive(slot, primitive)) return limit;
  RayResult result{target_.all.shapes, near.ray, closest_.any, limit, hits_[number_[i]]};
  return result.test(primitive);
}

template <std::uint32_t Room>
void RayPacket<Room>::trace_field(std::uint32_t i) {
  if (closest_.own_limit[i] < 0.0) return;
  struct FieldRay {
    RayPacket* packet;
    std::uint32_t ray;
  } field_ray{this, i};
  const SurfaceRay ray = own_[i];
  const Vec start = Vec::Map(ray.origin);
  const Vec low = start.array() - ray.slack;
  const Vec high = start.array() + ray.slack;
  height_cast(grid_of(*target_.body->field), low.data(), high.data(), ray.direction,
              closest_.own_limit[i],
              {[](void* context, const std::uint32_t* slots, std::uint32_t count, double limit) {
                 const FieldRay& on = *static_cast<FieldRay*>(context);
                 for (std::uint32_t k = 0; k < count && limit >= 0.0; ++k) {
                   limit = on.packet->test_in_field(on.ray, slots[k], limit);
                 }
                 return limit;
               },
               &field_ray});
}

template <std::uint32_t Room>
double RayPacket<Room>::test_in_field(std::uint32_t i, std::uint32_t slot, double own_before) {
  double corner[3][3];
  if (!target_.body->own_corners(slot, corner)) return own_before;
  SurfaceHit found;
  switch (mesh_ray_kernels().cross(own_[i], corner, found)) {
    case Crossing::none:
      break;
    case Crossing::found:
      return closest_.take(own_, i, slot, found, own_before);
    case Crossing::uncertain:
      return closest_.lower(own_, i, test(i, slot, closest_.limit[i]), own_before);
  }
  return own_before;
}

template <std::uint32_t Room>
void cast_in_packets(const RayTarget& target, std::span<const ShapeRay> rays, const double* limits,
                     bool any, PartHit* hits) {
  RayPacket<Room> packet(target, rays, any, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(limits[i] >= 0.0)) continue;
    packet.add(i, limits[i]);
    if (packet.is_full()) packet.trace();
  }
  packet.trace();
}

void cast_on_surface(const RayTarget& target, std::span<const ShapeRay> rays, const double* limits,
                     bool any, PartHit* hits) {
  const bool is_single = rays.size() == 1;
  (is_single ? cast_in_packets<1> : cast_in_packets<kRaysAtOnce>)(target, rays, limits, any, hits);
}

/// Tests a child of a compound that has surfaces; it is relative to the compound, as the ray is.
/// Returns the new limit.
[[nodiscard]] double cast_on_child(const TransformedShape& child, RayResult& result) {
  if (!child.is_surface()) {
    Primitive primitive;
    (void)child.primitive(0, primitive);
    return result.test(primitive);
  }
  RaySurface surface;
  prepare(child, surface);
  PartHit hit;
  cast_on_surface({child.all, surface, &child}, {&result.ray, 1}, &result.limit, result.any, &hit);
  return hit.found ? result.add(hit) : result.limit;
}

/// Limits for boxes of children are multiplied by this: rounding may make the hit of a triangle
/// earlier than the entry into the box of its child.
constexpr double kLimitRoom = 1.0 + 0x1p-20;

void cast_on_compound(const TransformedShape& body, std::span<const ShapeRay> rays,
                      const double* limits, bool any, PartHit* hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(limits[i] >= 0.0)) continue;
    const NearBody near(body, body.position, rays[i]);
    RayResult result{body.all.shapes, near.ray, any, limits[i], hits[i]};
    auto cast_child = [&](std::uint32_t number, double) {
      return cast_on_child(near.body.child(number), result) * kLimitRoom;
    };
    test_all_on_ray(near, result, ChildVisitor::of(cast_child));
  }
}

}  // namespace

void cast_rays(const CompositePool& pool, ShapeId id, const Pose& pose,
               std::span<const ShapeRay> rays, const double* limits, bool any, RaySurface* prepared,
               PartHit* hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i].found = false;
  const Composites* const all = composites_with(pool, id);
  if (all == nullptr) return;
  const bool is_prepared = prepared != nullptr && prepared->shape == id &&
                           prepared->revision == pool.revision() && is_same(prepared->pose, pose);
  if (is_prepared) return cast_on_surface({*all, *prepared}, rays, limits, any, hits);
  const TransformedShape body = TransformedShape::at(*all, id, pose, Solids::triangles);
  if (!body.is_surface()) return cast_on_compound(body, rays, limits, any, hits);
  RaySurface surface;
  prepare(body, surface);
  if (prepared != nullptr && surface.mesh != nullptr) {
    surface.shape = id;
    surface.pose = pose;
    surface.revision = pool.revision();
    *prepared = surface;
  }
  cast_on_surface({*all, surface, &body, body.position}, rays, limits, any, hits);
}

}  // namespace winnow::mid
