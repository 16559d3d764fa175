// Casts of a partition: rays and swept volumes. The public functions prepare casts, call a kernel
// (casts.kernel.cpp) and convert its results; hit_writer.h sorts all hits. Batches of rays run in
// parallel.

#include <winnow/core/volumes.h>
#include "core/numbers/rounding.h"
#include "core/threads/float_environment.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/queries/box_intersection.h"
#include "partitions/queries/hit_writer.h"
#include "partitions/queries/kernel_arguments.h"
#include "partitions/state/partition_observer.h"
#include "partitions/state/partition_state.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <variant>

namespace winnow {

WINNOW_DEFINE_KERNELS(CastKernels, cast_kernels)

void prepare_cast(KernelCast& cast, const Aabb& box, const Eigen::Vector3d& direction, double min_t,
                  double max_t) noexcept {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  // Below this speed, relative to the fastest axis, the product of the reciprocal and a length may
  // exceed the range of float.
  constexpr double kSlowest = 0x1p-120;
  cast.touch = nullptr;
  cast.shape = nullptr;
  cast.min_t = min_t;
  cast.max_t = max_t;
  const Eigen::Vector3d speed = direction.cwiseAbs();
  const double most = speed.maxCoeff();
  // The next power of two above `most`: its exponent bits plus one.
  const auto exponent = std::bit_cast<std::uint64_t>(most) >> 52U;
  cast.scale = std::bit_cast<double>((exponent + 1) << 52U);
  cast.scaled_from = round_down(min_t * cast.scale);
  for (int axis = 0; axis < 3; ++axis) {
    const double d = direction[axis];
    const auto a = static_cast<std::uint8_t>(axis);
    // Branchless: the direction is unpredictable. The leading end of the moving box reaches the
    // near end of a tested box, the trailing end leaves its far end.
    const auto back = static_cast<unsigned>(d < 0.0);
    const float end[2] = {box.max[axis], box.min[axis]};
    cast.near_column[a] = static_cast<std::uint8_t>(a + 3 * back);
    cast.far_column[a] = static_cast<std::uint8_t>(a + 3 - 3 * back);
    cast.near_origin[a] = end[back];
    cast.far_origin[a] = end[1 - back];
    cast.exact_near_column[a] = cast.near_column[a];
    cast.exact_near_origin[a] = static_cast<double>(cast.near_origin[a]);
    cast.exact_far_origin[a] = static_cast<double>(cast.far_origin[a]);
    cast.exact_inverse[a] = 1.0 / d;
    cast.inverse[a] = static_cast<float>(cast.exact_inverse[a] * cast.scale);
    if (d == 0.0) {
      cast.exact_inverse[a] = std::numeric_limits<double>::infinity();
      // Bounds of spheres beyond the range of float have infinite ends, which have no next float.
      if (cast.near_origin[a] < kInfinity) cast.near_origin[a] = next_up(cast.near_origin[a]);
      if (cast.far_origin[a] > -kInfinity) cast.far_origin[a] = -next_up(-cast.far_origin[a]);
      cast.inverse[a] = kInfinity;
    }
  }
  const double slow = kSlowest * cast.scale;
  if (speed.minCoeff() >= slow) return;
  const int fastest = speed.x() == most ? 0 : speed.y() == most ? 1 : 2;
  for (int axis = 0; axis < 3; ++axis) {
    if (speed[axis] == 0.0 || speed[axis] >= slow) continue;
    cast.near_column[axis] = cast.near_column[fastest];
    cast.far_column[axis] = cast.far_column[fastest];
    cast.near_origin[axis] = cast.near_origin[fastest];
    cast.far_origin[axis] = cast.far_origin[fastest];
    cast.inverse[axis] = cast.inverse[fastest];
  }
}

namespace {

/// A ray is the cast of a point.
void prepare_ray(KernelCast& cast, const Ray& ray) noexcept {
  prepare_cast(cast, Aabb{ray.origin, ray.origin}, ray.direction.cast<double>(),
               static_cast<double>(ray.min_t), static_cast<double>(ray.max_t));
}

/// A cast prepared for the kernels. Not movable, because the kernel's cast points into it.
class PreparedCast {
 public:
  explicit PreparedCast(const Cast& cast) noexcept {
    std::visit(
        [this](const auto& c) {
          valid_ = c.is_valid();
          if (valid_) prepare(c);
        },
        cast);
  }
  PreparedCast(const PreparedCast&) = delete;
  PreparedCast& operator=(const PreparedCast&) = delete;

  [[nodiscard]] bool valid() const noexcept { return valid_; }
  [[nodiscard]] const KernelCast& kernel_cast() const noexcept { return kernel_cast_; }

 private:
  void prepare(const Ray& ray) noexcept { prepare_ray(kernel_cast_, ray); }
  void prepare(const BoxCast& cast) noexcept { prepare_box(cast.box, cast); }
  void prepare(const SphereCast& cast) noexcept {
    prepare_box(cast.sphere.bounds(), cast);
    decide_by({cast.sphere.center, cast.sphere.center, cast.sphere.radius});
  }
  void prepare(const CapsuleCast& cast) noexcept {
    prepare_box(cast.capsule.bounds(), cast);
    decide_by(cast.capsule);
  }

  template <typename Moving>
  void prepare_box(const Aabb& box, const Moving& cast) noexcept {
    prepare_cast(kernel_cast_, box, cast.direction.template cast<double>(),
                 static_cast<double>(cast.min_t), static_cast<double>(cast.max_t));
    capsule_.direction = cast.direction.template cast<double>();
  }
  void decide_by(const Capsule& capsule) noexcept {
    capsule_.capsule = capsule;
    capsule_.max_t = kernel_cast_.max_t;
    kernel_cast_.touch = touch_capsule;
    kernel_cast_.shape = &capsule_;
  }

  bool valid_;
  KernelCast kernel_cast_;
  MovingCapsule capsule_;
};

constexpr std::size_t kGroup = HitWriter::kGroup;
// Groups that are sorted before the next ones are traced, while their hits are in the cache.
constexpr std::size_t kGroupsTogether = 16;

bool all_valid(const RayBatch& rays) noexcept {
  for (std::size_t i = 0; i < rays.count; ++i) {
    if (!rays[i].is_valid()) return false;
  }
  return true;
}

/// Returns a bit per axis: 1 if the ray goes in the negative direction.
unsigned octant(const Ray& ray) noexcept {
  unsigned result = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    result |= static_cast<unsigned>(ray.direction[static_cast<int>(axis)] < 0.0F) << axis;
  }
  return result;
}

/// A part of a batch of rays, split into groups of one octant that traverse the trees together.
class RayChunk {
 public:
  RayChunk(const RayBatch& rays, std::size_t begin, std::size_t end) noexcept : rays_(rays) {
    std::array<std::uint32_t, 9> start{};
    for (std::size_t i = begin; i < end; ++i) ++start[octant(rays[i]) + 1];
    for (std::size_t o = 0; o < 8; ++o) start[o + 1] += start[o];
    for (std::size_t i = begin; i < end; ++i) {
      ray_index_[start[octant(rays[i])]++] = static_cast<std::uint32_t>(i);
    }
    left_ = ray_index_.data();
    end_ = left_ + (end - begin);
  }
  RayChunk(const RayChunk&) = delete;
  RayChunk& operator=(const RayChunk&) = delete;

  /// Prepares the next group. False if there is none.
  bool next() noexcept {
    query_numbers_ = left_;
    count_ = 0;
    while (left_ != end_ && count_ < kMaxCasts) {
      prepare_ray(kernel_cast_[count_], rays_[*left_]);
      // A slow axis has the columns of another axis.
      if (count_ != 0 && !same_octant(kernel_cast_[0], kernel_cast_[count_])) break;
      ++count_;
      ++left_;
    }
    return count_ != 0;
  }
  [[nodiscard]] const KernelCast* kernel_casts() const noexcept { return kernel_cast_.data(); }
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  /// Per cast, the index of its ray in the batch.
  [[nodiscard]] const std::uint32_t* query_numbers() const noexcept { return query_numbers_; }

 private:
  const RayBatch& rays_;
  std::array<std::uint32_t, kGroup> ray_index_;
  std::array<KernelCast, kMaxCasts> kernel_cast_;
  const std::uint32_t* query_numbers_ = nullptr;
  const std::uint32_t* left_;
  const std::uint32_t* end_;
  std::uint32_t count_ = 0;
};

void write_columns(const HitColumns& out, std::size_t i, const Hit& hit) noexcept {
  if (out.key != nullptr) out.key[i] = hit.key;
  if (out.data != nullptr) out.data[i] = hit.data;
  if (out.t != nullptr) out.t[i] = hit.t;
}

/// Returns the hit of a kernel's result; a null hit if there is none.
Hit hit_or_null(const KeyTable& keys, std::uint64_t result) noexcept {
  return result != kNoHit ? to_hit(keys, result) : Hit{};
}

/// A kernel that finds one hit per cast.
using FindHits = void (*)(const QueryView&, const KernelCast*, std::uint32_t count,
                          const QueryFilter&, std::uint64_t* found);

Answer<Hit> find_hit(const PartitionState& state, FindHits find, const Cast& cast,
                     const Filter& filter) {
  const PreparedCast prepared(cast);
  if (!prepared.valid()) return Status::invalid_argument;
  QueryView view;
  if (const Status status = state.prepare(QueryKind::casts, 1, view); status != Status::ok) {
    return status;
  }
  const KernelFilter kernel_filter(filter, view, state.rows.keys());
  if (kernel_filter.matches_nothing()) return Hit{};
  std::uint64_t found = kNoHit;
  find(view, &prepared.kernel_cast(), 1, kernel_filter.query_filter(), &found);
  return hit_or_null(state.rows.keys(), found);
}

Status find_hits(const PartitionState& state, FindHits find, const RayBatch& rays,
                 const HitColumns& hits, const Filter& filter) {
  if (!all_valid(rays)) return Status::invalid_argument;
  QueryView view;
  if (const Status status = state.prepare(QueryKind::casts, rays.count, view);
      status != Status::ok) {
    return status;
  }
  const KeyTable& keys = state.rows.keys();
  const KernelFilter kernel_filter(filter, view, keys);
  if (kernel_filter.matches_nothing()) {
    for (std::size_t i = 0; i < rays.count; ++i) write_columns(hits, i, {});
    return Status::ok;
  }
  // Small tasks, so that a batch of a few thousand rays occupies every thread.
  constexpr std::size_t kTask = kGroup / 4;
  state.rows.execution().for_each((rays.count + kTask - 1) / kTask, [&](std::size_t task) {
    RayChunk chunk(rays, task * kTask, std::min(rays.count, (task + 1) * kTask));
    std::array<std::uint64_t, kMaxCasts> found;
    while (chunk.next()) {
      find(view, chunk.kernel_casts(), chunk.count(), kernel_filter.query_filter(), found.data());
      for (std::uint32_t i = 0; i < chunk.count(); ++i) {
        write_columns(hits, chunk.query_numbers()[i], hit_or_null(keys, found[i]));
      }
    }
  });
  return Status::ok;
}

}  // namespace

Answer<Hit> Partition::closest(const Cast& cast, const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  const Answer<Hit> hit = find_hit(*state_, cast_kernels().closest, cast, filter);
  if (is_observed(hit.status, state_)) state_->observer->closest(cast, filter, hit);
  return hit;
}

Answer<Hit> Partition::any(const Cast& cast, const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  const Answer<Hit> hit = find_hit(*state_, cast_kernels().any, cast, filter);
  if (is_observed(hit.status, state_)) state_->observer->any(cast, filter, hit);
  return hit;
}

Status Partition::closest(const RayBatch& rays, const HitColumns& hits,
                          const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  const Status status = find_hits(*state_, cast_kernels().closest, rays, hits, filter);
  if (is_observed(status, state_)) state_->observer->closest(rays, filter, hits);
  return status;
}

Status Partition::any(const RayBatch& rays, const HitColumns& hits, const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  const Status status = find_hits(*state_, cast_kernels().any, rays, hits, filter);
  if (is_observed(status, state_)) state_->observer->any(rays, filter, hits);
  return status;
}

Status Partition::all(const Cast& cast, HitBuffer& hits, const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  hits.clear();
  if (state_ == nullptr) return status_;
  const PreparedCast prepared(cast);
  if (!prepared.valid()) return Status::invalid_argument;
  QueryView view;
  if (const Status status = state_->prepare(QueryKind::casts, 1, view); status != Status::ok) {
    return status;
  }
  const KeyTable& keys = state_->rows.keys();
  if (!HitWriter::start(hits, 1)) return Status::out_of_memory;
  const KernelFilter kernel_filter(filter, view, keys);
  const Execution here = Execution::serial();
  PairWriter writer(HitWriter::found(hits), here);
  const Status status = writer.append(1, [&](std::size_t, PairSink& sink) {
    const std::uint32_t query = 0;
    return kernel_filter.matches_nothing() ||
           cast_kernels().all(view, &prepared.kernel_cast(), 1, &query,
                              kernel_filter.query_filter(), sink);
  });
  if (status == Status::ok && HitWriter::finish(hits, 0, 1, keys, here)) {
    if (state_->observer != nullptr) state_->observer->all(cast, filter, hits);
    return Status::ok;
  }
  hits.clear();
  return Status::out_of_memory;
}

Status Partition::all(const RayBatch& rays, HitBuffer& hits, const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  hits.clear();
  if (state_ == nullptr) return status_;
  if (rays.count > kMaxObjects || !all_valid(rays)) return Status::invalid_argument;
  QueryView view;
  if (const Status status = state_->prepare(QueryKind::casts, rays.count, view);
      status != Status::ok) {
    return status;
  }
  const KeyTable& keys = state_->rows.keys();
  const Execution& execution = state_->rows.execution();
  if (!HitWriter::start(hits, rays.count)) return Status::out_of_memory;
  const KernelFilter kernel_filter(filter, view, keys);
  const std::size_t step = execution.concurrency() == 1 ? kGroup : kGroup * kGroupsTogether;
  for (std::size_t first = 0; first < rays.count; first += step) {
    const std::size_t last = std::min(rays.count, first + step);
    PairWriter writer(HitWriter::found(hits), execution);
    const std::size_t groups = (last - first + kGroup - 1) / kGroup;
    const Status status = writer.append(groups, [&](std::size_t task, PairSink& sink) {
      const std::size_t begin = first + task * kGroup;
      RayChunk chunk(rays, begin, std::min(last, begin + kGroup));
      while (!kernel_filter.matches_nothing() && chunk.next()) {
        if (!cast_kernels().all(view, chunk.kernel_casts(), chunk.count(), chunk.query_numbers(),
                                kernel_filter.query_filter(), sink)) {
          return false;
        }
      }
      return true;
    });
    if (status != Status::ok || !HitWriter::finish(hits, first, last, keys, execution)) {
      hits.clear();
      return Status::out_of_memory;
    }
  }
  if (state_->observer != nullptr) state_->observer->all(rays, filter, hits);
  return Status::ok;
}

}  // namespace winnow
