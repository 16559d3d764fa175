// RowPartition: rays and swept volumes.

#include <winnow/partitions/pair_writer.h>
#include <winnow/partitions/queries/cast.kernel.h>
#include <winnow/partitions/queries/hit_writer.h>
#include <winnow/partitions/queries/query_filter.h>
#include <winnow/partitions/queries/sweep.h>
#include <winnow/partitions/queries/touch.h>
#include <winnow/partitions/row_partition.h>

#include <algorithm>
#include <array>
#include <variant>

namespace winnow {

WINNOW_DEFINE_KERNELS(CastKernels, cast_kernels)

namespace {

/// A cast ready for the kernels. Not to be moved: the sweep points into it.
class PreparedCast {
 public:
  explicit PreparedCast(const Cast& cast) noexcept {
    valid_ = std::visit([](const auto& c) { return c.is_valid(); }, cast);
    if (valid_) std::visit([this](const auto& c) { prepare(c); }, cast);
  }
  PreparedCast(const PreparedCast&) = delete;
  PreparedCast& operator=(const PreparedCast&) = delete;

  [[nodiscard]] bool valid() const noexcept { return valid_; }
  [[nodiscard]] const Sweep& sweep() const noexcept { return sweep_; }

 private:
  void prepare(const Ray& ray) noexcept { sweep_ = make_sweep(ray); }
  void prepare(const BoxCast& cast) noexcept { sweep_of(cast.box, cast); }
  void prepare(const SphereCast& cast) noexcept {
    sweep_of(cast.sphere.bounds(), cast);
    decide_by({cast.sphere.center, cast.sphere.center, cast.sphere.radius});
  }
  void prepare(const CapsuleCast& cast) noexcept {
    sweep_of(cast.capsule.bounds(), cast);
    decide_by(cast.capsule);
  }

  template <typename Moving>
  void sweep_of(const Aabb& box, const Moving& cast) noexcept {
    sweep_ = make_sweep(box, cast.direction.template cast<double>(),
                        static_cast<double>(cast.min_t), static_cast<double>(cast.max_t));
    capsule_.direction = cast.direction.template cast<double>();
  }
  void decide_by(const Capsule& capsule) noexcept {
    capsule_.capsule = capsule;
    capsule_.min_t = sweep_.min_t;
    capsule_.max_t = sweep_.max_t;
    sweep_.touch = touch_capsule;
    sweep_.shape = &capsule_;
  }

  bool valid_;
  Sweep sweep_;
  MovingCapsule capsule_;
};

std::size_t tasks_for(std::size_t rays) noexcept {
  return (rays + kMostSweeps - 1) / kMostSweeps;
}

bool all_valid(const RayBatch& rays) noexcept {
  for (std::size_t i = 0; i < rays.count; ++i) {
    if (!rays[i].is_valid()) return false;
  }
  return true;
}

/// As many rays of a batch as are walked together.
struct Sweeps {
  std::array<Sweep, kMostSweeps> sweep;
  std::uint32_t first;
  std::uint32_t count;

  Sweeps(const RayBatch& rays, std::size_t task) noexcept
      : first(static_cast<std::uint32_t>(task * kMostSweeps)),
        count(static_cast<std::uint32_t>(std::min<std::size_t>(kMostSweeps, rays.count - first))) {
    for (std::uint32_t i = 0; i < count; ++i) sweep[i] = make_sweep(rays[first + i]);
  }
};

void write_columns(const HitColumns& out, std::size_t i, const Hit& hit) noexcept {
  if (out.key != nullptr) out.key[i] = hit.key;
  if (out.data != nullptr) out.data[i] = hit.data;
  if (out.t != nullptr) out.t[i] = hit.t;
}

bool is_hit(std::uint64_t found) noexcept {
  return found != ~std::uint64_t{0};
}

}  // namespace

Status RowPartition::closest(const Cast& cast, Hit& hit, const Filter& filter) const {
  hit = {};
  const PreparedCast prepared(cast);
  if (!prepared.valid()) return Status::invalid_argument;
  QueryView view;
  if (const Status status = prepare(view); status != Status::ok) return status;
  const KernelFilter wanted(filter, view, keys_);
  if (wanted.meets_nothing()) return Status::ok;
  std::uint64_t best = 0;
  cast_kernels().closest(view, &prepared.sweep(), 1, wanted.wanted(), &best);
  if (is_hit(best)) hit = to_hit(keys_, best);
  return Status::ok;
}

Status RowPartition::any(const Cast& cast, Hit& hit, const Filter& filter) const {
  hit = {};
  const PreparedCast prepared(cast);
  if (!prepared.valid()) return Status::invalid_argument;
  QueryView view;
  if (const Status status = prepare(view); status != Status::ok) return status;
  const KernelFilter wanted(filter, view, keys_);
  std::uint64_t found = 0;
  if (!wanted.meets_nothing() &&
      cast_kernels().any(view, prepared.sweep(), wanted.wanted(), found)) {
    hit = to_hit(keys_, found);
  }
  return Status::ok;
}

Status RowPartition::closest(const RayBatch& rays, const HitColumns& hits,
                             const Filter& filter) const {
  if (!all_valid(rays)) return Status::invalid_argument;
  QueryView view;
  if (const Status status = prepare(view); status != Status::ok) return status;
  const KernelFilter wanted(filter, view, keys_);
  execution_.for_each(tasks_for(rays.count), [&](std::size_t task) {
    const Sweeps sweeps(rays, task);
    std::array<std::uint64_t, kMostSweeps> best;
    if (wanted.meets_nothing()) {
      best.fill(~std::uint64_t{0});
    } else {
      cast_kernels().closest(view, sweeps.sweep.data(), sweeps.count, wanted.wanted(), best.data());
    }
    for (std::uint32_t i = 0; i < sweeps.count; ++i) {
      write_columns(hits, sweeps.first + i, is_hit(best[i]) ? to_hit(keys_, best[i]) : Hit{});
    }
  });
  return Status::ok;
}

Status RowPartition::any(const RayBatch& rays, const HitColumns& hits, const Filter& filter) const {
  // Walked together, the closest hit comes as cheap as any.
  return closest(rays, hits, filter);
}

Status RowPartition::all(const Cast& cast, HitBuffer& hits, const Filter& filter) const {
  hits.clear();
  const PreparedCast prepared(cast);
  if (!prepared.valid()) return Status::invalid_argument;
  QueryView view;
  if (const Status status = prepare(view); status != Status::ok) return status;
  const KernelFilter wanted(filter, view, keys_);
  const Execution here = Execution::serial();
  PairWriter writer(HitWriter::found(hits), here);
  const Status status = writer.append(1, [&](std::size_t, PairSink& sink) {
    return wanted.meets_nothing() ||
           cast_kernels().all(view, &prepared.sweep(), 1, 0, wanted.wanted(), sink);
  });
  if (status == Status::ok && HitWriter::finish(hits, 1, keys_, here)) return Status::ok;
  hits.clear();
  return Status::out_of_memory;
}

Status RowPartition::all(const RayBatch& rays, HitBuffer& hits, const Filter& filter) const {
  hits.clear();
  if (rays.count > kMaxObjects || !all_valid(rays)) return Status::invalid_argument;
  QueryView view;
  if (const Status status = prepare(view); status != Status::ok) return status;
  const KernelFilter wanted(filter, view, keys_);
  PairWriter writer(HitWriter::found(hits), execution_);
  const Status status = writer.append(tasks_for(rays.count), [&](std::size_t task, PairSink& sink) {
    const Sweeps sweeps(rays, task);
    return wanted.meets_nothing() || cast_kernels().all(view, sweeps.sweep.data(), sweeps.count,
                                                        sweeps.first, wanted.wanted(), sink);
  });
  if (status == Status::ok && HitWriter::finish(hits, rays.count, keys_, execution_)) {
    return Status::ok;
  }
  hits.clear();
  return Status::out_of_memory;
}

}  // namespace winnow
