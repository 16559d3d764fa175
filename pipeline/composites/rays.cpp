// Rays against meshes, height fields and compounds (mid::visit_rays and visit_ray). Rays are
// transformed to the frame of the surface; the surface and its triangles are not transformed.
// Intersections are computed by pipeline/mesh (mesh_rays.h, height_grid.h).

#include "pipeline/composites/composites.h"
#include "pipeline/composites/transformed_shape.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_rays.h"
#include "pipeline/shapes/two_diff.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace winnow::mid {
namespace {

/// Transforms a normal from the frame of the surface to the world, and normalises it.
[[nodiscard]] Vec unit_under(const SurfaceFrame& frame, const Vec& normal) noexcept {
  const Eigen::Map<const Mat> transposed(frame.world_to_local[0]);
  const auto times = [&](const Vec& of) {
    return Vec(transposed.col(0).dot(of), transposed.col(1).dot(of), transposed.col(2).dot(of));
  };
  const Vec plain = frame.is_rotated ? times(normal) : normal;
  const double square = plain.squaredNorm();
  constexpr double kSafe = 1e200;
  if (square > 1.0 / kSafe && square < kSafe) return plain * (1.0 / std::sqrt(square));
  return times(normal.stableNormalized()).stableNormalized();
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

/// Returns a - b + t * d with compensated sums: the rounding error is relative to the result, not
/// to the terms.
[[nodiscard]] double moved(double a, double b, double t, double d) noexcept {
  const double between = a - b;
  const double back = between - a;
  const double lost = (a - (between - back)) + (-b - back);
  const double step = t * d;
  const double step_error = std::fma(t, d, -step);
  const double sum = between + step;
  const double half = sum - step;
  const double sum_error = (between - half) + (step - (sum - half));
  return sum + (sum_error + step_error + lost);
}

/// A body and a ray, both relative to `about`. The rounding error of the ray's origin is subtracted
/// from the position of the body.
struct NearBody {
  NearBody(const TransformedShape& placed, const Vec& about, const ShapeRay& of) noexcept
      : ray(of), body(placed) {
    const TwoDiff between = difference(of.origin, about.data());
    std::copy_n(between.difference, 3, ray.origin);
    body.position = (placed.position - about) - Vec::Map(between.rest);
  }

  ShapeRay ray;
  TransformedShape body;
};

/// A surface as the target of rays. Visitors get primitives relative to `about`.
struct RayTarget {
  RayTarget(const TransformedShape& placed, const Vec& show_about) noexcept
      : body(placed), about(show_about) {
    const bool is_mesh = body.kind == TransformedShape::Kind::mesh;
    const Aabb bounds = is_mesh ? body.shared->mesh.bounds() : body.field->bounds();
    Vec corner;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corner[static_cast<Eigen::Index>(axis)] =
          static_cast<double>(std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis])));
    }
    Vec::Map(frame.position) = body.position;
    Mat::Map(frame.world_to_local[0]) = body.to_local;
    frame.is_rotated = body.to_local != Mat::Identity();
    frame.reach = corner.maxCoeff();
    frame.size = (body.to_world.cwiseAbs() * corner).sum();
  }

  const TransformedShape& body;
  const Vec& about;
  SurfaceFrame frame;
};

/// Transforms a vector to the frame of the surface; sums in the order of the columns.
void turn_into(const SurfaceFrame& frame, const double (&v)[3], double (&own)[3]) noexcept {
  const auto& column = frame.world_to_local;
  for (int i = 0; i < 3; ++i) {
    own[i] = column[0][i] * v[0] + column[1][i] * v[1] + column[2][i] * v[2];
  }
}
/// Upper bound on the coordinates of the transformed vector, for any signs of `v`.
[[nodiscard]] double largest_turned(const SurfaceFrame& frame, const double (&v)[3]) noexcept {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto part = [&](int k) { return std::abs(frame.world_to_local[k][i]) * std::abs(v[k]); };
    largest = std::max(largest, part(0) + part(1) + part(2));
  }
  return largest;
}
[[nodiscard]] double largest_of(const double (&v)[3]) noexcept {
  return std::max(std::max(std::abs(v[0]), std::abs(v[1])), std::abs(v[2]));
}
[[nodiscard]] double dot(const double (&a)[3], const double (&b)[3]) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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
  const double towards = -dot(start, ray.direction);
  const double square = dot(ray.direction, ray.direction);
  double shift = 0.0;
  if (towards > 4.0 * frame.size * (square / fastest)) [[unlikely]] {
    shift = std::max(0.0, towards / square - 4.0 * frame.size / fastest);
    for (int i = 0; i < 3; ++i) {
      start[i] = moved(ray.origin[i], frame.position[i], shift, ray.direction[i]);
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
    std::copy_n(ray.direction, 3, way);
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

/// Converts t of the caller to t of the ray in the frame of a surface ("own" t).
struct LocalRayTime {
  double shift;
  /// 1 / t_scale, a power of two.
  double unit;

  [[nodiscard]] double operator()(double t) const noexcept { return (t - shift) * unit; }
  /// Upper bound of own t, including rounding errors.
  [[nodiscard]] double limit(double t) const noexcept {
    return (*this)(t) + 0x1p-51 * (std::abs(t) + std::abs(shift)) * unit;
  }
  /// As above with a wider bound, for a limit that comes from another surface: rounding may make
  /// the hit of a triangle that the ray grazes earlier than the entry into its box.
  [[nodiscard]] double first_limit(double t, double reach) const noexcept {
    const double most = limit(t);
    return most + 0x1p-20 * (std::abs(most) + reach);
  }
  /// Returns the new own limit after the caller's limit changed from `before` to `now`.
  [[nodiscard]] double after(double before, double now, double own_before) const noexcept {
    if (now < 0.0) return -1.0;
    return now < before ? limit(now) : own_before;
  }
};

/// Traces up to `Room` rays through a surface and reports the triangles that they hit.
template <std::uint32_t Room>
class RayPacket {
 public:
  RayPacket(const RayTarget& target, std::span<const ShapeRay> rays,
            const RayVisitor& visitor) noexcept
      : target_(target), rays_(rays), visitor_(visitor) {}

  [[nodiscard]] bool is_full() const noexcept { return count_ == Room; }
  void add(std::size_t ray, double limit) noexcept;
  /// Traces the added rays. Calls elsewhere(ray) for rays that cannot be transformed to the frame.
  template <typename Elsewhere>
  void go(Elsewhere&& elsewhere);

 private:
  /// Transforms the rays with the kernel. Returns one bit for each ray that is left to place_ray.
  [[nodiscard]] std::uint64_t place() noexcept;
  void go_through_mesh();
  void go_through_field(std::uint32_t i);
  [[nodiscard]] LocalRayTime time(std::uint32_t i) const noexcept {
    return {own_.shift[i], unit_[i]};
  }
  // Functions that report triangles return the new own limit.
  [[nodiscard]] double visit_hit(std::uint32_t i, std::uint32_t slot, const SurfaceHit& found,
                                 double own_before);
  [[nodiscard]] double visit_candidate(std::uint32_t i, std::uint32_t slot, double own_before);
  [[nodiscard]] double show(std::uint32_t i, std::uint32_t slot, double own_before);
  /// Sets the limit in the caller's t, and returns the new own limit.
  [[nodiscard]] double after(std::uint32_t i, double limit, double own_before) noexcept;

  const RayTarget& target_;
  std::span<const ShapeRay> rays_;
  const RayVisitor& visitor_;
  std::uint32_t count_ = 0;
  /// Indices of the rays that the visitor is called with.
  std::size_t number_[Room];
  /// Limits in the caller's t, and initial limits in own t.
  double limit_[Room];
  alignas(kRayAlignment<Room>) double own_limit_[Room];
  RayColumns<Room> world_;
  SurfaceRayColumns<Room> own_;
  /// See LocalRayTime.
  double unit_[Room];
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
  limit_[count_] = limit;
  ++count_;
}

template <std::uint32_t Room>
std::uint64_t RayPacket<Room>::place() noexcept {
  if constexpr (Room == 1) {
    return 1;
  } else {
    const std::uint32_t rest = (kRayLanes - count_ % kRayLanes) % kRayLanes;
    const std::uint32_t last = count_ - 1;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(world_.origin[axis] + count_, rest, world_.origin[axis][last]);
      std::fill_n(world_.direction[axis] + count_, rest, world_.direction[axis][last]);
    }
    std::fill_n(own_limit_ + count_, rest, -1.0);
    return mesh_kernels().place_rays(target_.frame, world_, count_, own_);
  }
}

template <std::uint32_t Room>
template <typename Elsewhere>
void RayPacket<Room>::go(Elsewhere&& elsewhere) {
  if (count_ == 0) return;
  for (std::uint64_t left = place(); left != 0; left &= left - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
    if (place_ray(target_.frame, rays_[number_[i]], i, own_)) continue;
    elsewhere(number_[i]);
    limit_[i] = -1.0;
    own_.shift[i] = 0.0;
    own_.t_scale[i] = 1.0;
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    unit_[i] = 1.0 / own_.t_scale[i];
    const LocalRayTime own = time(i);
    own_limit_[i] = limit_[i] >= 0.0 ? own.first_limit(limit_[i], target_.frame.reach) : -1.0;
    own_.low[i] = own(0.0);
    own_.high[i] = own(rays_[number_[i]].max_t);
  }
  if (target_.body.kind == TransformedShape::Kind::mesh) {
    go_through_mesh();
  } else {
    for (std::uint32_t i = 0; i < count_; ++i) go_through_field(i);
  }
  count_ = 0;
}

template <std::uint32_t Room>
void RayPacket<Room>::go_through_mesh() {
  const RaySlotVisitor visitor{
      [](void* context, std::uint32_t ray, std::uint32_t slot, const SurfaceHit& found,
         double limit) {
        return static_cast<RayPacket*>(context)->visit_hit(ray, slot, found, limit);
      },
      [](void* context, std::uint32_t ray, std::uint32_t slot, double limit) {
        return static_cast<RayPacket*>(context)->visit_candidate(ray, slot, limit);
      },
      this};
  if constexpr (Room == 1) {
    mesh_ray(*target_.body.mesh, own_, own_limit_[0], visitor);
  } else {
    mesh_rays(*target_.body.mesh, own_, own_limit_, count_, visitor);
  }
}

template <std::uint32_t Room>
void RayPacket<Room>::go_through_field(std::uint32_t i) {
  if (own_limit_[i] < 0.0) return;
  struct FieldRay {
    RayPacket* guides;
    std::uint32_t ray;
  } way{this, i};
  const SurfaceRay ray = own_[i];
  const Vec start = Vec::Map(ray.origin);
  const Vec low = start.array() - ray.slack;
  const Vec high = start.array() + ray.slack;
  height_cast(grid_of(*target_.body.field), low.data(), high.data(), ray.direction, own_limit_[i],
              {[](void* context, const std::uint32_t* slots, std::uint32_t count, double limit) {
                 const FieldRay& on = *static_cast<FieldRay*>(context);
                 for (std::uint32_t k = 0; k < count && limit >= 0.0; ++k) {
                   limit = on.guides->show(on.ray, slots[k], limit);
                 }
                 return limit;
               },
               &way});
}

template <std::uint32_t Room>
double RayPacket<Room>::show(std::uint32_t i, std::uint32_t slot, double own_before) {
  double corner[3][3];
  if (!target_.body.own_corners(slot, corner)) return own_before;
  SurfaceHit found;
  switch (cross_triangle(own_[i], corner, found)) {
    case Crossing::none:
      break;
    case Crossing::found:
      return visit_hit(i, slot, found, own_before);
    case Crossing::uncertain:
      return visit_candidate(i, slot, own_before);
  }
  return own_before;
}

template <std::uint32_t Room>
double RayPacket<Room>::visit_hit(std::uint32_t i, std::uint32_t slot, const SurfaceHit& found,
                                  double own_before) {
  ShapeHit hit;
  hit.hit = true;
  hit.t = own_.shift[i] + found.t * own_.t_scale[i];
  if (!(hit.t <= limit_[i])) return own_before;
  if (target_.body.front != 0) {
    double corner[3][3];
    (void)target_.body.own_corners(slot, corner);
    if (comes_from_behind(own_[i], corner)) return own_before;
  }
  Vec::Map(hit.normal) = unit_under(target_.frame, Vec::Map(found.normal));
  const std::uint32_t number = target_.body.shown_number(slot);
  return after(i, visitor_.visit_hit(visitor_.context, number_[i], number, hit, limit_[i]),
               own_before);
}

template <std::uint32_t Room>
double RayPacket<Room>::visit_candidate(std::uint32_t i, std::uint32_t slot, double own_before) {
  Primitive primitive;
  const NearBody near(target_.body, target_.about, rays_[number_[i]]);
  if (!near.body.primitive(slot, primitive)) return own_before;
  return after(i, visitor_.visit_candidate(visitor_.context, number_[i], primitive, limit_[i]),
               own_before);
}

template <std::uint32_t Room>
double RayPacket<Room>::after(std::uint32_t i, double limit, double own_before) noexcept {
  const double before = limit_[i];
  limit_[i] = limit;
  return time(i).after(before, limit, own_before);
}

/// Calls `visitor.visit_candidate` for all primitives whose boxes ray `number` hits; for a compound
/// that has surfaces, calls `children` instead.
void visit_all_on_ray(const NearBody& near, std::size_t number, const RayVisitor& visitor,
                      const ChildVisitor& children) {
  // Relative growth of the ray's box before the box tests, which round coordinates.
  constexpr double kGrowth = 0x1p-47;
  const Eigen::Map<const Vec> from(near.ray.origin);
  const double grow = kGrowth * from.cwiseAbs().maxCoeff();
  MovingBox moving_box;
  for (int i = 0; i < 3; ++i) {
    moving_box.min[i] = from[i] - grow;
    moving_box.max[i] = from[i] + grow;
    moving_box.direction[i] = near.ray.direction[i];
  }
  moving_box.max_t = near.ray.max_t;
  struct ChildRay {
    const RayVisitor& visitor;
    std::size_t number;
  } child_ray{visitor, number};
  visit(near.body, moving_box,
        {[](void* context, const Primitive& primitive, double most) {
           const ChildRay& by = *static_cast<ChildRay*>(context);
           return by.visitor.visit_candidate(by.visitor.context, by.number, primitive, most);
         },
         &child_ray},
        children);
}

/// One ray, number 0, through a mesh that was prepared by `prepare_ray_surface`.
class SingleRay {
 public:
  SingleRay(const Composites& all, const RaySurface& surface, const ShapeRay& ray, double limit,
            const RayVisitor& visitor) noexcept
      : all_(all), surface_(surface), ray_(ray), visitor_(visitor), limit_(limit) {}

  void go();

 private:
  [[nodiscard]] LocalRayTime time() const noexcept { return {own_.shift[0], unit_}; }
  [[nodiscard]] NearBody near() const noexcept {
    const TransformedShape body = TransformedShape::at(all_, surface_.shape, surface_.pose);
    return {body, body.position, ray_};
  }
  // As in RayPacket.
  [[nodiscard]] double visit_hit(std::uint32_t slot, const SurfaceHit& found, double own_before);
  [[nodiscard]] double visit_candidate(std::uint32_t slot, double own_before);
  [[nodiscard]] double after(double limit, double own_before) noexcept {
    const double before = limit_;
    limit_ = limit;
    return time().after(before, limit, own_before);
  }

  const Composites& all_;
  const RaySurface& surface_;
  const ShapeRay& ray_;
  const RayVisitor& visitor_;
  double limit_;
  double unit_ = 1.0;
  SingleSurfaceRay own_;
};

void SingleRay::go() {
  if (!place_ray(surface_.frame, ray_, 0, own_)) return visit_all_on_ray(near(), 0, visitor_, {});
  unit_ = 1.0 / own_.t_scale[0];
  own_.low[0] = time()(0.0);
  own_.high[0] = time()(ray_.max_t);
  mesh_ray(
      *surface_.mesh, own_, time().first_limit(limit_, surface_.frame.reach),
      {[](void* context, std::uint32_t, std::uint32_t slot, const SurfaceHit& found, double limit) {
         return static_cast<SingleRay*>(context)->visit_hit(slot, found, limit);
       },
       [](void* context, std::uint32_t, std::uint32_t slot, double limit) {
         return static_cast<SingleRay*>(context)->visit_candidate(slot, limit);
       },
       this});
}

double SingleRay::visit_hit(std::uint32_t slot, const SurfaceHit& found, double own_before) {
  ShapeHit hit;
  hit.hit = true;
  hit.t = own_.shift[0] + found.t * own_.t_scale[0];
  if (!(hit.t <= limit_)) return own_before;
  if (surface_.front != 0) {
    double corner[3][3];
    put_corners(*surface_.mesh, slot, corner);
    if (comes_from_behind(own_[0], corner)) return own_before;
  }
  Vec::Map(hit.normal) = unit_under(surface_.frame, Vec::Map(found.normal));
  const std::uint32_t number = surface_.mesh->triangle[slot] & kTriangleNumberMask;
  return after(visitor_.visit_hit(visitor_.context, 0, number, hit, limit_), own_before);
}

double SingleRay::visit_candidate(std::uint32_t slot, double own_before) {
  Primitive primitive;
  if (!near().body.primitive(slot, primitive)) return own_before;
  return after(visitor_.visit_candidate(visitor_.context, 0, primitive, limit_), own_before);
}

template <std::uint32_t Room>
void guide_rays(const RayTarget& target, std::span<const ShapeRay> rays, const double* limits,
                const RayVisitor& visitor) {
  const auto visit_candidates = [&](std::size_t ray) {
    visit_all_on_ray(NearBody(target.body, target.about, rays[ray]), ray, visitor, {});
  };
  RayPacket<Room> guides(target, rays, visitor);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(limits[i] >= 0.0)) continue;
    guides.add(i, limits[i]);
    if (guides.is_full()) guides.go(visit_candidates);
  }
  guides.go(visit_candidates);
}

/// Visitors get primitives relative to `about`.
void visit_surface(const TransformedShape& surface, const Vec& about,
                   std::span<const ShapeRay> rays, const double* limits,
                   const RayVisitor& visitor) {
  const RayTarget target(surface, about);
  const bool is_single = rays.size() == 1;
  (is_single ? guide_rays<1> : guide_rays<kRaysAtOnce>)(target, rays, limits, visitor);
}

/// Traces ray `number` through a child of a compound that has surfaces; both are relative to the
/// compound. Returns the new limit.
[[nodiscard]] double visit_child(const TransformedShape& child, const ShapeRay& ray,
                                 std::size_t number, double limit, const RayVisitor& visitor) {
  if (!child.is_surface()) {
    Primitive primitive;
    (void)child.primitive(0, primitive);
    return visitor.visit_candidate(visitor.context, number, primitive, limit);
  }
  struct ForwardedRay {
    const RayVisitor& to;
    std::size_t number;
    double limit;
  } passing{visitor, number, limit};
  visit_surface(
      child, Vec::Zero(), {&ray, 1}, &limit,
      {[](void* context, std::size_t, std::uint32_t part, const ShapeHit& hit, double most) {
         ForwardedRay& by = *static_cast<ForwardedRay*>(context);
         return by.limit = by.to.visit_hit(by.to.context, by.number, part, hit, most);
       },
       [](void* context, std::size_t, const Primitive& primitive, double most) {
         ForwardedRay& by = *static_cast<ForwardedRay*>(context);
         return by.limit = by.to.visit_candidate(by.to.context, by.number, primitive, most);
       },
       &passing});
  return passing.limit;
}

/// Limits for boxes of children are multiplied by this: rounding may make the hit of a triangle
/// earlier than the entry into the box of its child.
constexpr double kLimitRoom = 1.0 + 0x1p-20;

}  // namespace

void visit_rays(const CompositePool& pool, ShapeId id, const Pose& pose,
                std::span<const ShapeRay> rays, const double* limits, const RayVisitor& visitor) {
  const Composites* const all = composites_with(pool, id);
  if (all == nullptr) return;
  const TransformedShape body = TransformedShape::at(*all, id, pose);
  if (body.is_surface()) return visit_surface(body, body.position, rays, limits, visitor);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(limits[i] >= 0.0)) continue;
    const NearBody near(body, body.position, rays[i]);
    double limit = limits[i];
    auto show_child = [&](std::uint32_t number, double) {
      limit = visit_child(near.body.child(number), near.ray, i, limit, visitor);
      return limit * kLimitRoom;
    };
    visit_all_on_ray(near, i, visitor, ChildVisitor::of(show_child));
  }
}

bool prepare_ray_surface(const CompositePool& pool, ShapeId id, const Pose& pose,
                         RaySurface& surface) noexcept {
  const Composites* const all = composites_of(pool);
  if (all == nullptr || all->mesh(id) == nullptr) return false;
  const TransformedShape body = TransformedShape::at(*all, id, pose);
  const RayTarget target(body, body.position);
  surface = {.shape = id,
             .pose = pose,
             .revision = pool.revision(),
             .mesh = body.mesh,
             .frame = target.frame,
             .front = body.front};
  return true;
}

void visit_ray(const CompositePool& pool, const RaySurface& surface, const ShapeRay& ray,
               double limit, const RayVisitor& visitor) {
  if (limit >= 0.0) SingleRay(*composites_of(pool), surface, ray, limit, visitor).go();
}

}  // namespace winnow::mid
