// ImpactBatch: sorts queries into jobs of one pair of kinds and one type of motion, runs the lane
// kernels (impact_lanes.kernel.cpp), and resolves pairs that touch at the start with the narrow
// phase's distance kernels. Called by time_of_impact.cpp and scene/continuous_impacts.cpp.

#include "pipeline/motion/impact_batch.h"

#include "pipeline/kernels/kernels.h"
#include "pipeline/shapes/pair_order.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace winnow {

WINNOW_DEFINE_KERNELS(ImpactLaneKernels, impact_lane_kernels)

namespace impact {
namespace {

/// Number of values of ImpactMotion.
constexpr std::size_t kMotions = 3;
/// The key of pairs that the lanes do not support.
constexpr std::uint16_t kNoLanes = kMotions * kShapeKinds * kShapeKinds;

[[nodiscard]] bool is_straight(const ImpactQuery& query, std::size_t side) noexcept {
  const Vec3d& turn = query.motion[side]->turn;
  return query.shape[side].kind() == ShapeKind::sphere ||
         (turn[0] == 0.0 && turn[1] == 0.0 && turn[2] == 0.0);
}

[[nodiscard]] ImpactMotion motion_of(const ImpactQuery& query) noexcept {
  const bool turns_b = !is_straight(query, 1);
  if (turns_b && query.shape[1].kind() == ShapeKind::half_space) return ImpactMotion::plane_turns;
  return turns_b || !is_straight(query, 0) ? ImpactMotion::turns : ImpactMotion::straight;
}

/// Returns the key of a query. Queries with equal keys form one job; key % kMotions is its
/// ImpactMotion.
[[nodiscard]] std::uint16_t kinds_of(const ImpactQuery& query) noexcept {
  const ShapeKind a = query.shape[0].kind();
  const ShapeKind b = query.shape[1].kind();
  if (a == ShapeKind::half_space) return kNoLanes;
  const std::size_t kinds = static_cast<std::size_t>(a) * kShapeKinds + static_cast<std::size_t>(b);
  return static_cast<std::uint16_t>(kMotions * kinds + static_cast<std::size_t>(motion_of(query)));
}

/// Computes the distances at time 0 of pairs with the same two kinds of shape, by the narrow
/// phase's kernels.
class StartDistances {
 public:
  explicit StartDistances(const ShapeTables& tables) noexcept {
    job_.tables = &tables;
    job_.pairs = pairs_.data();
    job_.shapes = shapes_.data();
    job_.poses = poses_.data();
    job_.distance = distance_.data();
    job_.error_bound = error_bound_.data();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      job_.normal[axis] = normal_[axis].data();
      job_.point[axis] = point_[axis].data();
    }
    job_.uncertified = uncertified_.data();
  }

  [[nodiscard]] bool is_full() const noexcept { return job_.count == kRoom; }
  void add(std::size_t query, const ImpactQuery& given) noexcept {
    queries_[job_.count] = query;
    given_[job_.count] = &given;
    mirrored_ = is_mirrored(given.shape[0], given.shape[1]);
    pairs_[job_.count] = {2 * job_.count + (mirrored_ ? 1U : 0U),
                          2 * job_.count + (mirrored_ ? 0U : 1U)};
    for (std::size_t side = 0; side < 2; ++side) {
      shapes_[2 * job_.count + side] = given.shape[side];
      poses_[2 * job_.count + side] = given.motion[side]->start;
    }
    ++job_.count;
  }

  /// Calls decided(index of the query) for each pair with a certified distance of at most 0, and
  /// writes its impact to the reference that the call returns. Clears the stage.
  template <typename Known>
  void run(Known&& decided) noexcept {
    if (job_.count != 0) answer(decided);
    job_.count = 0;
  }

 private:
  template <typename Known>
  void answer(Known& decided) noexcept {
    const NarrowKernels* const kernels =
        narrow_kernels(shapes_[pairs_[0].a].kind(), shapes_[pairs_[0].b].kind());
    if (kernels == nullptr) return;
    const std::uint32_t left = kernels->of_level[kernel_index(ContactLevel::distance)](job_);
    for (std::uint32_t i = 0; i < left; ++i) distance_[uncertified_[i]] = 1.0;
    for (std::size_t i = 0; i < job_.count; ++i) {
      if (!(distance_[i] <= 0.0)) continue;
      Impact& found = decided(queries_[i]);
      found = {true,
               0.0,
               distance_[i],
               error_bound_[i],
               {normal_[0][i], normal_[1][i], normal_[2][i]},
               {point_[0][i], point_[1][i], point_[2][i]}};
      if (mirrored_) mirror_impact(*given_[i]->motion[0], *given_[i]->motion[1], found);
    }
  }

  static constexpr std::size_t kRoom = 64;
  template <typename T>
  using Row = std::array<T, kRoom>;

  NarrowJob job_{};
  /// Whether the kernel takes the shapes in the opposite order.
  bool mirrored_ = false;
  Row<std::size_t> queries_;
  Row<const ImpactQuery*> given_;
  Row<BodyPair> pairs_;
  std::array<ShapeId, 2 * kRoom> shapes_;
  std::array<Pose, 2 * kRoom> poses_;
  Row<double> distance_;
  Row<double> error_bound_;
  Row<double> normal_[3];
  Row<double> point_[3];
  Row<std::uint32_t> uncertified_;
};

}  // namespace

void ImpactBatch::add(std::size_t name, ShapeId a, const RigidMotion& of_a, ShapeId b,
                      const RigidMotion& of_b, double until) noexcept {
  const bool mirrored = solver::is_prepared_mirrored(a.kind(), b.kind());
  names_[count_] = name;
  mirrored_[count_] = mirrored;
  ImpactQuery& query = queries_[count_];
  if (mirrored) {
    query = {{b, a}, {&of_b, &of_a}, until};
  } else {
    query = {{a, b}, {&of_a, &of_b}, until};
  }
  kinds_[count_] = kinds_of(query);
  alike_ = alike_ && kinds_[count_] == kinds_[0];
  ++count_;
}

void ImpactBatch::sort_by_kinds() noexcept {
  if (alike_) {
    std::iota(order_.begin(), order_.begin() + count_, std::uint16_t{0});
    return;
  }
  std::array<std::uint16_t, kNoLanes + 2> first{};
  for (std::size_t i = 0; i < count_; ++i) ++first[kinds_[i] + 1U];
  for (std::size_t k = 1; k < first.size(); ++k) {
    first[k] = static_cast<std::uint16_t>(first[k] + first[k - 1]);
  }
  for (std::size_t i = 0; i < count_; ++i) {
    order_[first[kinds_[i]]++] = static_cast<std::uint16_t>(i);
  }
}

/// Marks pairs with an invalid motion; the lanes report these as unsure.
void ImpactBatch::refuse_invalid(const ImpactJob& job) noexcept {
  for (const std::uint16_t query : std::span(job.order, job.count)) {
    if (verdicts_[query] != ImpactVerdict::unsure) continue;
    const RigidMotion* const(&motion)[2] = queries_[query].motion;
    if (motion[0]->is_valid() && motion[1]->is_valid()) continue;
    found_[query] = {};
    verdicts_[query] = ImpactVerdict::invalid;
  }
}

/// Resolves pairs that the lanes could not decide at time 0; most of them overlap there.
void ImpactBatch::find_starts(const ImpactJob& job) noexcept {
  const std::span<const std::uint16_t> order(job.order, job.count);
  const auto at_start = [&](std::uint16_t query) {
    return verdicts_[query] == ImpactVerdict::unsure && found_[query].time == 0.0;
  };
  if (std::ranges::none_of(order, at_start)) return;
  StartDistances starts(tables_);
  const auto decided = [&](std::size_t query) -> Impact& {
    verdicts_[query] = ImpactVerdict::decided;
    return found_[query];
  };
  for (const std::uint16_t query : order) {
    if (!at_start(query)) continue;
    if (starts.is_full()) starts.run(decided);
    starts.add(query, queries_[query]);
  }
  starts.run(decided);
}

void ImpactBatch::search(std::size_t i) noexcept {
  const ImpactQuery& query = queries_[i];
  found_[i] =
      find_impact(tables_, {query.shape[0], *query.motion[0]}, {query.shape[1], *query.motion[1]},
                  tolerance_, {found_[i].time, 1.0}, query.until);
}

void ImpactBatch::find() noexcept {
  sort_by_kinds();
  ImpactJob job{ImpactMotion::straight, tables_,         queries_.data(), nullptr, 0, tolerance_,
                found_.data(),          verdicts_.data()};
  for (std::size_t at = 0; at < count_; at += job.count) {
    const std::uint16_t kinds = kinds_[order_[at]];
    job.order = order_.data() + at;
    job.count = 1;
    while (at + job.count < count_ && kinds_[job.order[job.count]] == kinds) ++job.count;
    if (kinds != kNoLanes) {
      job.motion = static_cast<ImpactMotion>(kinds % kMotions);
      impact_lane_kernels().run(job);
    } else {
      for (std::uint32_t i = 0; i < job.count; ++i) {
        verdicts_[job.order[i]] = ImpactVerdict::unsure;
        found_[job.order[i]].time = 0.0;
      }
    }
    refuse_invalid(job);
    if (kinds != kNoLanes) find_starts(job);
  }
}

}  // namespace impact
}  // namespace winnow
