// Ways of bodies are boxed and put into a partition of their own, which is asked for pairs among
// them and with the scene's partitions. What is found is judged by balls, and then exactly. Where
// ways are long because most bodies go the same way, pairs among them are asked for in a frame that
// goes with them.

#include <winnow/pipeline/scene_sweep.h>

#include <winnow/core/aabb.h>
#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/sort/radix_sort.h"
#include "core/sort/stretches.h"
#include "pipeline/motion/body_impact.h"
#include "pipeline/motion/impact_batch.h"
#include "pipeline/motion/passage.h"
#include "pipeline/scene/scene_state.h"
#include "pipeline/shapes/difference.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>

namespace winnow {

/// A part of the way of a body, in time, that has a box of its own.
struct WayPiece {
  std::uint32_t mover;
  impact::Interval within;
};

namespace {

constexpr std::uint32_t kNoMover = ~0U;
constexpr std::size_t kMoversPerStretch = 64;
constexpr std::size_t kCandidatesPerStretch = 256;
/// So many pairs are looked at before what they say spares others.
constexpr std::size_t kPairsPerRound = 1024;
/// To so many bits pairs are ordered by when they may meet, in steps of time.
constexpr unsigned kTimeBits = 11;
constexpr double kTimeSteps = (1U << kTimeBits) - 1U;
/// Of a candidate whose balls do not meet.
constexpr std::uint64_t kNoChance = ~std::uint64_t{0};
/// A frame that moves shortens ways to less than this share, and by more than so many radii.
constexpr double kShortened = 0.25;
constexpr double kLongWay = 4.0;
/// More than rounding changes times by, and the sizes of balls as a share of them.
constexpr double kRounding = 1e-9;

/// Room for a motion, which nothing is written to before there is one.
union MotionRoom {
  MotionRoom() noexcept {}
  RigidMotion motion;
};

[[nodiscard]] auto order_of(const SceneImpact& impact) noexcept {
  return std::tuple(impact.time, impact.a.id, impact.b.id);
}

}  // namespace

/// A candidate, and until when its impact is wanted.
struct SweptPair {
  std::uint32_t candidate;
  double until;
};

struct SweepState {
  SweepState(Scene& swept_scene, SceneState& its_state, std::pmr::memory_resource* memory) noexcept
      : scene(swept_scene),
        bodies(its_state),
        parts(its_state.shapes, its_state.options.composites),
        ways(linear_bvh(), {.memory = memory, .execution = its_state.options.execution}),
        motions(memory),
        movers(memory),
        mover_of(memory),
        along_axis(memory),
        first_piece(memory),
        boxes(memory),
        pieces(memory),
        piece_of(memory),
        piece_keys(memory),
        pairs(memory),
        candidates(memory),
        spare(memory),
        chances(memory),
        round(memory),
        listed(memory),
        answers(memory),
        found(memory),
        first_time(memory),
        impacts(memory),
        first(memory) {}

  [[nodiscard]] Status take(std::span<const Key> keys, const PoseView& ends) noexcept;
  [[nodiscard]] Status take(std::span<const Key> keys, std::span<const RigidMotion> given) noexcept;
  [[nodiscard]] bool choose_drift() noexcept;
  [[nodiscard]] Status box_ways();
  [[nodiscard]] Status set_filters();
  [[nodiscard]] Status find_pairs_among(const SweepOptions& options);
  [[nodiscard]] bool is_met(Motion motion, const SweepOptions& options) const noexcept;
  [[nodiscard]] Status find_pairs_with(Motion motion, const SweepOptions& options);
  [[nodiscard]] Status find_pairs(const SweepOptions& options);
  [[nodiscard]] Status find_all(const SweepOptions& options);
  [[nodiscard]] Status find_first(const SweepOptions& options);
  [[nodiscard]] bool sort_candidates() noexcept;
  void sort_impacts() noexcept;
  void forget() noexcept {
    impacts.clear();
    std::fill(first.begin(), first.end(), kNoImpact);
  }

  Scene& scene;
  SceneState& bodies;
  PartTraversal parts;
  Partition ways;
  /// By mover: its motion and which body it is; by body, which mover.
  Column<RigidMotion> motions;
  Column<std::uint32_t> movers;
  Column<std::uint32_t> mover_of;
  /// By Motion, how many bodies move.
  std::array<std::size_t, kMotions> movers_in{};
  /// How the frame moves in which ways are boxed, and what movers go along one axis.
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  Column<double> along_axis;
  /// By mover, and one more.
  Column<std::uint32_t> first_piece;
  Column<PlainBox> boxes;
  Column<WayPiece> pieces;
  /// By object of `ways`.
  Column<std::uint32_t> piece_of;
  Column<Key> piece_keys;
  PairBuffer pairs;
  /// Pairs of bodies as (smaller id << 32 | larger id), sorted.
  Column<std::uint64_t> candidates;
  Column<std::uint64_t> spare;
  /// Candidates whose balls meet, as (when << 32 | candidate), sorted; when in time steps.
  Column<std::uint64_t> chances;
  /// By kinds of shapes, and as they were listed.
  Column<SweptPair> round;
  Column<SweptPair> listed;
  Column<impact::BodyImpact> answers;
  /// By candidate or, where there is one, by mover; and when the latter is.
  Column<impact::BodyImpact> found;
  Column<double> first_time;
  Column<SceneImpact> impacts;
  Column<std::uint32_t> first;
  SweepStatistics statistics;

 private:
  /// From which boxes are measured.
  [[nodiscard]] RigidMotion frame() const noexcept {
    const Eigen::Vector3d& at = bodies.origin;
    RigidMotion frame = RigidMotion::standing(Pose::at(at.x(), at.y(), at.z()));
    Eigen::Vector3d::Map(frame.travel) = drift;
    return frame;
  }
  [[nodiscard]] impact::MovingShape way_of(std::size_t mover) const noexcept {
    return impact::whole_shape(parts, bodies.shape[movers[mover]], motions[mover]);
  }
  [[nodiscard]] bool count_pieces() noexcept;
  void box_way(std::uint32_t mover) noexcept;
  [[nodiscard]] Status take_bodies(std::span<const Key> keys) noexcept;
  [[nodiscard]] const double (&start_of(std::uint32_t body) const noexcept)[3] {
    const std::uint32_t mover = mover_of[body];
    return mover == kNoMover ? bodies.pose[body].position : motions[mover].start.position;
  }
  [[nodiscard]] RigidMotion motion_of(std::uint32_t body) const noexcept {
    const std::uint32_t mover = mover_of[body];
    return mover == kNoMover ? RigidMotion::standing(bodies.pose[body]) : motions[mover];
  }
  [[nodiscard]] Status list_chances(double tolerance);
  [[nodiscard]] bool list_round(std::size_t& at) noexcept;
  [[nodiscard]] bool sort_round() noexcept;
  void keep_first(std::uint32_t candidate, const impact::BodyImpact& impact) noexcept;
  [[nodiscard]] std::array<std::uint32_t, 2> bodies_of(std::uint32_t candidate) const noexcept {
    return {static_cast<std::uint32_t>(candidates[candidate] >> 32U),
            static_cast<std::uint32_t>(candidates[candidate])};
  }
  [[nodiscard]] impact::Interval window_of(std::uint64_t candidate,
                                           double tolerance = 0.0) const noexcept;
  [[nodiscard]] double begin_of(std::uint64_t candidate, double tolerance) const noexcept;
  void find_impacts(std::span<const SweptPair> asked, const SweepOptions& options,
                    impact::BodyImpact* impacts_of) const noexcept;
  [[nodiscard]] SceneImpact shown(std::uint64_t candidate,
                                  const impact::BodyImpact& impact) const noexcept;
  template <typename Body>
  [[nodiscard]] Status collect(Body&& second_body);
};

namespace {

/// Which pairs of ways, or of ways and bodies that stand, are looked at.
struct WayJudge {
  const SweepState& sweep;
  const SweepOptions& options;
  /// Null: ways among themselves.
  const SceneSet* standing;

  [[nodiscard]] bool is_bullet(std::uint32_t mover) const noexcept {
    return !options.bullets.empty() && options.bullets[mover] != 0;
  }
  [[nodiscard]] bool may_pair(std::uint32_t a, std::uint32_t b, bool bullet) const noexcept {
    const Motion of_a = sweep.bodies.motion[a];
    const Motion of_b = sweep.bodies.motion[b];
    if (of_a != Motion::dynamic && of_b != Motion::dynamic) return false;
    const bool fixed = of_a == Motion::fixed || of_b == Motion::fixed;
    const bool wanted = options.pairs == SweepPairs::all ||
                        (bullet && options.pairs != SweepPairs::fixed) ||
                        (fixed && options.pairs != SweepPairs::bullets);
    return wanted && sweep.bodies.may_pair(a, b);
  }
  [[nodiscard]] bool accept(ObjectId first, ObjectId second) const noexcept {
    const WayPiece& piece = sweep.pieces[sweep.piece_of[first]];
    const std::uint32_t body = sweep.movers[piece.mover];
    if (standing != nullptr) {
      const std::uint32_t other = standing->body_of[second];
      return sweep.mover_of[other] == kNoMover && may_pair(body, other, is_bullet(piece.mover));
    }
    const WayPiece& then = sweep.pieces[sweep.piece_of[second]];
    if (piece.mover == then.mover || piece.within.first > then.within.last ||
        then.within.first > piece.within.last) {
      return false;
    }
    return may_pair(body, sweep.movers[then.mover],
                    is_bullet(piece.mover) || is_bullet(then.mover));
  }
  [[nodiscard]] PairOptions asked() const noexcept {
    PairOptions asked;
    asked.incremental = false;
    asked.predicate = {[](void* context, ObjectId first, ObjectId second) {
                         return static_cast<const WayJudge*>(context)->accept(first, second);
                       },
                       const_cast<WayJudge*>(this)};
    return asked;
  }
};

}  // namespace

Status SweepState::take_bodies(std::span<const Key> keys) noexcept {
  if (!motions.resize(keys.size()) || !movers.resize(keys.size()) ||
      !mover_of.resize(bodies.shape.size()) || !first.resize(keys.size())) {
    return Status::out_of_memory;
  }
  std::fill(mover_of.begin(), mover_of.end(), kNoMover);
  movers_in = {};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    movers[i] = keys[i].id;
    mover_of[keys[i].id] = static_cast<std::uint32_t>(i);
    ++movers_in[static_cast<std::size_t>(bodies.motion[keys[i].id])];
  }
  return Status::ok;
}

Status SweepState::take(std::span<const Key> keys, const PoseView& ends) noexcept {
  const auto motion_to = [&](std::size_t i) {
    const Pose& start = bodies.pose[keys[i].id];
    Pose end = ends[i];
    if (!ends.has_orientations()) std::copy_n(start.orientation, 4, end.orientation);
    return RigidMotion::between(start, end);
  };
  if (keys.size() != ends.count) return Status::size_mismatch;
  if (!bodies.are_distinct(keys)) return Status::invalid_key;
  if (!motions.resize(keys.size())) return Status::out_of_memory;
  for_stretches(bodies.options.execution, keys.size(), kMoversPerStretch,
                [&](std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin; i < end; ++i) motions[i] = motion_to(i);
                });
  const auto is_valid = [](const RigidMotion& motion) { return motion.is_valid(); };
  return std::ranges::all_of(motions, is_valid) ? take_bodies(keys) : Status::invalid_pose;
}

Status SweepState::take(std::span<const Key> keys, std::span<const RigidMotion> given) noexcept {
  if (keys.size() != given.size()) return Status::size_mismatch;
  if (!bodies.are_distinct(keys)) return Status::invalid_key;
  const bool valid =
      std::ranges::all_of(given, [](const RigidMotion& motion) { return motion.is_valid(); });
  if (!valid) return Status::invalid_pose;
  const Status status = take_bodies(keys);
  if (status == Status::ok) std::ranges::copy(given, motions.begin());
  return status;
}

/// Along each axis the median of what movers travel, or nothing where ways are not much longer for
/// that.
bool SweepState::choose_drift() noexcept {
  drift.setZero();
  const std::size_t count = movers.size();
  if (!along_axis.resize(count)) return false;
  if (count == 0) return true;
  Eigen::Vector3d common;
  double as_they_are = 0.0;
  double shortened = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) along_axis[i] = motions[i].travel[axis];
    double* const middle = along_axis.data() + count / 2;
    std::nth_element(along_axis.begin(), middle, along_axis.end());
    common[axis] = *middle;
    for (const double way : along_axis) {
      as_they_are += std::abs(way);
      shortened += std::abs(way - common[axis]);
    }
  }
  double radii = 0.0;
  for (const std::uint32_t body : movers) radii += bodies.radius(body);
  const bool shortens =
      shortened < kShortened * as_they_are && as_they_are - shortened > kLongWay * radii;
  if (shortens) drift = common;
  return true;
}

/// Says into how many pieces each way is cut.
bool SweepState::count_pieces() noexcept {
  const std::size_t count = movers.size();
  if (!first_piece.resize(count + 1)) return false;
  const RigidMotion origin = frame();
  std::uint32_t total = 0;
  for (std::size_t i = 0; i < count; ++i) {
    first_piece[i] = total;
    const impact::MovingShape moving = way_of(i);
    total += impact::Passage(parts, origin, moving).piece_count();
  }
  first_piece[count] = total;
  statistics.boxes += total;
  return boxes.resize(total) && pieces.resize(total) && piece_keys.resize(total);
}

void SweepState::box_way(std::uint32_t mover) noexcept {
  const RigidMotion origin = frame();
  const impact::MovingShape moving = way_of(mover);
  const impact::Passage passage(parts, origin, moving);
  const std::uint32_t begin = first_piece[mover];
  const std::uint32_t count = first_piece[mover + 1] - begin;
  for (std::uint32_t i = 0; i < count; ++i) {
    pieces[begin + i] = {mover, impact::piece_of(i, count)};
    const PreciseBox box = passage.box(pieces[begin + i].within);
    const Aabb outward = Aabb::outward(box.min, box.max);
    for (int axis = 0; axis < 3; ++axis) {
      boxes[begin + i].min[axis] = outward.min[axis];
      boxes[begin + i].max[axis] = outward.max[axis];
    }
  }
}

/// Fills `ways` anew.
Status SweepState::box_ways() {
  if (!count_pieces()) return Status::out_of_memory;
  for_stretches(bodies.options.execution, movers.size(), kMoversPerStretch,
                [&](std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin; i < end; ++i) box_way(static_cast<std::uint32_t>(i));
                });
  ways.clear();
  if (pieces.empty()) return Status::ok;
  const PlainBox* const box = boxes.data();
  const BoxView view{{&box->min[0], &box->min[1], &box->min[2]},
                     {&box->max[0], &box->max[1], &box->max[2]},
                     pieces.size(),
                     sizeof(PlainBox)};
  const std::span<Key> keys{piece_keys.data(), pieces.size()};
  if (const Status status = ways.insert(view, {}, keys); status != Status::ok) return status;
  std::size_t objects = 0;
  for (const Key& key : keys) objects = std::max(objects, key.id + std::size_t{1});
  if (!piece_of.resize(objects)) return Status::out_of_memory;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) piece_of[keys[i].id] = i;
  return set_filters();
}

Status SweepState::set_filters() {
  for (std::uint32_t mover = 0; mover < movers.size(); ++mover) {
    const std::uint32_t body = movers[mover];
    ObjectFilter filter;
    Status status = bodies.set(bodies.motion[body]).partition->filter(bodies.place[body], filter);
    for (std::uint32_t i = first_piece[mover];
         status == Status::ok && filter != ObjectFilter{} && i < first_piece[mover + 1]; ++i) {
      status = ways.set_filter(piece_keys[i], filter);
    }
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

/// Adds the pairs that were found, of which the second is `second_body` of an object.
template <typename Body>
Status SweepState::collect(Body&& second_body) {
  const std::size_t before = candidates.size();
  if (!candidates.grow(before + pairs.size())) return Status::out_of_memory;
  candidates.set_size(before + pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t a = movers[pieces[piece_of[pairs[i].first]].mover];
    const std::uint32_t b = second_body(pairs[i].second);
    candidates[before + i] = std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
  }
  return Status::ok;
}

/// Each once: a pair is found for each two pieces.
bool SweepState::sort_candidates() noexcept {
  const std::size_t count = candidates.size();
  if (!spare.resize(count)) return false;
  const auto bits = static_cast<unsigned>(std::bit_width(bodies.shape.size()));
  const Execution& execution = bodies.options.execution;
  std::uint64_t* sorted = candidates.data();
  for (const unsigned digit : {0U, 32U}) {
    std::uint64_t* const other = sorted == candidates.data() ? spare.data() : candidates.data();
    sorted = radix_sort(sorted, other, count, bits, execution, digit);
  }
  const std::uint64_t* const end = std::unique_copy(sorted, sorted + count, candidates.data());
  candidates.set_size(static_cast<std::size_t>(end - candidates.data()));
  return true;
}

Status SweepState::find_pairs_among(const SweepOptions& options) {
  const WayJudge among{*this, options, nullptr};
  const Status status = ways.self_pairs(pairs, among.asked());
  if (status != Status::ok) return status;
  return collect([&](ObjectId way) { return movers[pieces[piece_of[way]].mover]; });
}

/// Whether movers may meet bodies of a set that stand.
bool SweepState::is_met(Motion motion, const SweepOptions& options) const noexcept {
  const SceneSet& set = bodies.set(motion);
  if (!set.partition.has_value()) return false;
  if (set.partition->size() == movers_in[static_cast<std::size_t>(motion)]) return false;
  return options.pairs != SweepPairs::fixed || motion == Motion::fixed ||
         movers_in[static_cast<std::size_t>(Motion::fixed)] > 0;
}

Status SweepState::find_pairs_with(Motion motion, const SweepOptions& options) {
  const SceneSet& set = bodies.set(motion);
  const WayJudge with{*this, options, &set};
  const Status status = ways.pairs_with(*set.partition, pairs, with.asked());
  if (status != Status::ok) return status;
  return collect([&](ObjectId id) { return set.body_of[id]; });
}

Status SweepState::find_pairs(const SweepOptions& options) {
  candidates.clear();
  statistics = {};
  if (!choose_drift()) return Status::out_of_memory;
  Status status = box_ways();
  if (status == Status::ok) status = find_pairs_among(options);
  for (const Motion motion : kEveryMotion) {
    if (!is_met(motion, options)) continue;
    if (status == Status::ok && !drift.isZero(0.0)) {
      drift.setZero();
      status = box_ways();
    }
    if (status == Status::ok) status = find_pairs_with(motion, options);
  }
  if (status != Status::ok) return status;
  if (!sort_candidates()) return Status::out_of_memory;
  statistics.body_pairs = candidates.size();
  return Status::ok;
}

/// When the balls around the two overlap, or are closer than this share of their sizes.
impact::Interval SweepState::window_of(std::uint64_t candidate, double tolerance) const noexcept {
  constexpr double kStands[3] = {0.0, 0.0, 0.0};
  const auto a = static_cast<std::uint32_t>(candidate >> 32U);
  const auto b = static_cast<std::uint32_t>(candidate);
  const auto travel = [&](std::uint32_t body) -> const double(&)[3] {
    const std::uint32_t mover = mover_of[body];
    return mover == kNoMover ? kStands : motions[mover].travel;
  };
  const Difference apart = difference(start_of(b), start_of(a));
  return impact::ball_window(Eigen::Vector3d::Map(apart.difference),
                             Eigen::Vector3d::Map(travel(b)) - Eigen::Vector3d::Map(travel(a)),
                             (bodies.radius(a) + bodies.radius(b)) * (1.0 + tolerance));
}

/// No impact of a candidate is found before; beyond the end of time if there is none. Most are near
/// each other from the start, which needs no root.
double SweepState::begin_of(std::uint64_t candidate, double tolerance) const noexcept {
  const auto a = static_cast<std::uint32_t>(candidate >> 32U);
  const auto b = static_cast<std::uint32_t>(candidate);
  const Difference apart = difference(start_of(b), start_of(a));
  const double reach = bodies.radius(a) + bodies.radius(b);
  if (Eigen::Vector3d::Map(apart.difference).squaredNorm() < reach * reach) return 0.0;
  // A gap of the tolerance is an impact, and rounding may find it a little sooner.
  const impact::Interval window = window_of(candidate, tolerance + kRounding);
  return window.first <= window.last ? std::max(0.0, window.first - kRounding) : 2.0;
}

/// The first impacts of no more pairs than fit into a batch; `impacts_of` gets one of each.
void SweepState::find_impacts(std::span<const SweptPair> asked, const SweepOptions& options,
                              impact::BodyImpact* impacts_of) const noexcept {
  impact::ImpactBatch batch(bodies.shapes.tables(), options.tolerance);
  std::array<MotionRoom, impact::ImpactBatch::kRoom> standing;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const impact::Interval window = window_of(candidates[asked[i].candidate]);
    if (window.first > window.last) {
      impacts_of[i] = {};
      continue;
    }
    const auto [a, b] = bodies_of(asked[i].candidate);
    // At most one of the two stands.
    const auto motion = [&](std::uint32_t body) -> const RigidMotion& {
      if (mover_of[body] != kNoMover) return motions[mover_of[body]];
      return *std::construct_at(&standing[i].motion, RigidMotion::standing(bodies.pose[body]));
    };
    const RigidMotion& of_a = motion(a);
    const RigidMotion& of_b = motion(b);
    if (impact::ImpactBatch::takes(bodies.shape[a], bodies.shape[b])) {
      batch.add(i, bodies.shape[a], of_a, bodies.shape[b], of_b, asked[i].until);
    } else {
      impacts_of[i] = impact::find_impact_of_balls(
          parts, {bodies.shape[a], of_a}, {bodies.shape[b], of_b}, options.tolerance, window);
    }
  }
  batch.run([&](std::size_t i, const impact::Impact& impact, bool) { impacts_of[i] = {impact}; });
  if (options.touching) return;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    impact::Impact& impact = impacts_of[i].impact;
    if (impact.time == 0.0 && impact.gap <= 0.0) impact.hit = false;
  }
}

/// The first impact of every pair.
Status SweepState::find_all(const SweepOptions& options) {
  if (!found.resize(candidates.size())) return Status::out_of_memory;
  for_stretches(bodies.options.execution, candidates.size(), impact::ImpactBatch::kRoom,
                [&](std::size_t begin, std::size_t end) {
                  std::array<SweptPair, impact::ImpactBatch::kRoom> asked;
                  for (std::size_t i = begin; i < end; ++i) {
                    asked[i - begin] = {static_cast<std::uint32_t>(i), 1.0};
                  }
                  find_impacts({asked.data(), end - begin}, options, found.data() + begin);
                });
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (found[i].impact.hit && !impacts.push_back(shown(candidates[i], found[i]))) {
      return Status::out_of_memory;
    }
  }
  return Status::ok;
}

/// Lists the candidates whose balls meet, the first that do first.
Status SweepState::list_chances(double tolerance) {
  const std::size_t count = candidates.size();
  if (!chances.resize(count)) return Status::out_of_memory;
  for_stretches(bodies.options.execution, count, kCandidatesPerStretch,
                [&](std::size_t begin, std::size_t end) {
                  for (std::size_t i = begin; i < end; ++i) {
                    const double meets = begin_of(candidates[i], tolerance);
                    const auto when = static_cast<std::uint64_t>(meets * kTimeSteps);
                    chances[i] = meets > 1.0 ? kNoChance : when << 32U | i;
                  }
                });
  std::uint64_t* const end = std::remove(chances.begin(), chances.end(), kNoChance);
  const auto size = static_cast<std::size_t>(end - chances.begin());
  const std::uint64_t* const sorted =
      radix_sort(chances.data(), spare.data(), size, kTimeBits, bodies.options.execution);
  if (sorted != chances.data()) std::copy_n(sorted, size, chances.data());
  chances.set_size(size);
  return Status::ok;
}

/// Fills a round with chances from `at` on: those that may be the first one of a body. False if
/// memory was refused.
bool SweepState::list_round(std::size_t& at) noexcept {
  listed.clear();
  for (; at < chances.size() && listed.size() < kPairsPerRound; ++at) {
    const auto candidate = static_cast<std::uint32_t>(chances[at]);
    double latest = 0.0;
    for (const std::uint32_t body : bodies_of(candidate)) {
      const std::uint32_t mover = mover_of[body];
      if (mover != kNoMover) latest = std::max(latest, first_time[mover]);
    }
    // In whole steps, and one more for what rounding takes.
    if (static_cast<double>(chances[at] >> 32U) > latest * kTimeSteps + 1.0) continue;
    if (!listed.push_back({candidate, latest})) return false;
  }
  return sort_round() && answers.resize(round.size());
}

/// Pairs of the same kinds are next to each other, so that batches have few kinds.
bool SweepState::sort_round() noexcept {
  constexpr std::size_t kKinds = 16;
  const auto kinds_of = [&](const SweptPair& pair) {
    const auto [a, b] = bodies_of(pair.candidate);
    const auto kind = [&](std::uint32_t body) {
      return static_cast<std::size_t>(bodies.shape[body].kind()) % kKinds;
    };
    return std::min(kind(a), kind(b)) * kKinds + std::max(kind(a), kind(b));
  };
  if (!round.resize(listed.size())) return false;
  std::array<std::uint32_t, kKinds * kKinds + 1> place{};
  for (const SweptPair& pair : listed) ++place[kinds_of(pair) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  for (const SweptPair& pair : listed) round[place[kinds_of(pair)]++] = pair;
  return true;
}

/// For each of the two whose first impact it is so far.
void SweepState::keep_first(std::uint32_t candidate, const impact::BodyImpact& impact) noexcept {
  if (!impact.impact.hit) return;
  for (const std::uint32_t body : bodies_of(candidate)) {
    const std::uint32_t mover = mover_of[body];
    if (mover == kNoMover) continue;
    if (first[mover] != kNoImpact &&
        std::tuple(first_time[mover], first[mover]) <= std::tuple(impact.impact.time, candidate)) {
      continue;
    }
    found[mover] = impact;
    first_time[mover] = impact.impact.time;
    first[mover] = candidate;
  }
}

Status SweepState::find_first(const SweepOptions& options) {
  if (const Status status = list_chances(options.tolerance); status != Status::ok) return status;
  const std::size_t count = movers.size();
  if (!found.resize(count) || !first_time.resize(count)) return Status::out_of_memory;
  std::fill(first_time.begin(), first_time.end(), 1.0);
  std::fill(first.begin(), first.end(), kNoImpact);
  for (std::size_t at = 0; at < chances.size();) {
    if (!list_round(at)) return Status::out_of_memory;
    for_stretches(
        bodies.options.execution, round.size(), impact::ImpactBatch::kRoom,
        [&](std::size_t begin, std::size_t end) {
          find_impacts({round.data() + begin, end - begin}, options, answers.data() + begin);
        });
    for (std::size_t i = 0; i < round.size(); ++i) keep_first(round[i].candidate, answers[i]);
  }
  for (std::uint32_t mover = 0; mover < count; ++mover) {
    if (first[mover] == kNoImpact) continue;
    // What is the first impact of both is shown once.
    const bool shown_before = std::ranges::any_of(bodies_of(first[mover]), [&](std::uint32_t body) {
      const std::uint32_t other = mover_of[body];
      return other < mover && first[other] == first[mover];
    });
    if (shown_before) continue;
    if (!impacts.push_back(shown(candidates[first[mover]], found[mover]))) {
      return Status::out_of_memory;
    }
  }
  return Status::ok;
}

SceneImpact SweepState::shown(std::uint64_t candidate,
                              const impact::BodyImpact& of_bodies) const noexcept {
  const impact::Impact& impact = of_bodies.impact;
  SceneImpact result;
  result.a = bodies.keys.key_of(static_cast<std::uint32_t>(candidate >> 32U));
  result.b = bodies.keys.key_of(static_cast<std::uint32_t>(candidate));
  result.data_a = bodies.keys.client_data(result.a.id);
  result.data_b = bodies.keys.client_data(result.b.id);
  result.part_a = of_bodies.part_a;
  result.part_b = of_bodies.part_b;
  result.time = impact.time;
  result.gap = impact.gap;
  result.error_bound = impact.error_bound;
  const RigidMotion of_a = motion_of(result.a.id);
  for (int i = 0; i < 3; ++i) {
    result.normal[i] = impact.normal[i];
    result.point[i] = of_a.start.position[i] + impact.time * of_a.travel[i] + impact.point[i];
  }
  return result;
}

/// Puts the impacts in order, and tells each mover which its first one is.
void SweepState::sort_impacts() noexcept {
  std::sort(impacts.begin(), impacts.end(),
            [](const SceneImpact& a, const SceneImpact& b) { return order_of(a) < order_of(b); });
  std::fill(first.begin(), first.end(), kNoImpact);
  for (std::uint32_t i = 0; i < impacts.size(); ++i) {
    for (const Key& key : {impacts[i].a, impacts[i].b}) {
      const std::uint32_t mover = mover_of[key.id];
      if (mover != kNoMover) first[mover] = std::min(first[mover], i);
    }
  }
}

SceneSweep::SceneSweep(Scene& scene, std::pmr::memory_resource* memory) noexcept
    : memory_(memory), state_(nullptr) {
  if (scene.state_ != nullptr) state_ = new_in<SweepState>(memory, scene, *scene.state_, memory);
}

SceneSweep::~SceneSweep() {
  delete_in(memory_, state_);
}

Status SceneSweep::sweep(std::span<const Key> keys, const PoseView& ends,
                         const SweepOptions& options) {
  return run(keys, options, [&] { return state_->take(keys, ends); });
}

Status SceneSweep::sweep(std::span<const Key> keys, std::span<const RigidMotion> motions,
                         const SweepOptions& options) {
  return run(keys, options, [&] { return state_->take(keys, motions); });
}

template <typename Take>
Status SceneSweep::run(std::span<const Key> keys, const SweepOptions& options, Take&& take) {
  if (state_ == nullptr) return logged(Status::out_of_memory, "SceneSweep::sweep");
  SweepState& s = *state_;
  Status status = Status::ok;
  if (!options.bullets.empty() && options.bullets.size() != keys.size()) {
    status = Status::size_mismatch;
  } else if (!(options.tolerance > 0.0 && options.tolerance <= 1.0) ||
             options.pairs > SweepPairs::bullets_and_fixed) {
    status = Status::invalid_argument;
  } else {
    status = s.scene.refresh();
  }
  if (status == Status::ok) status = take();
  if (status == Status::ok) status = s.find_pairs(options);
  if (status == Status::ok) {
    s.impacts.clear();
    status = options.first_only ? s.find_first(options) : s.find_all(options);
  }
  if (status == Status::ok) s.sort_impacts();
  if (status == Status::out_of_memory) s.forget();
  return logged(status, "SceneSweep::sweep");
}

std::span<const SceneImpact> SceneSweep::impacts() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->impacts.data(), state_->impacts.size()};
}

std::span<const std::uint32_t> SceneSweep::first() const noexcept {
  if (state_ == nullptr) return {};
  return {state_->first.data(), state_->first.size()};
}

SweepStatistics SceneSweep::statistics() const noexcept {
  return state_ != nullptr ? state_->statistics : SweepStatistics{};
}

Footprint SceneSweep::footprint() const noexcept {
  if (state_ == nullptr) return {};
  const SweepState& s = *state_;
  Footprint sum;
  sum.structure = {sizeof(SweepState), sizeof(SweepState)};
  for (const Bytes& bytes :
       {s.ways.footprint().total(), s.motions.bytes(), s.movers.bytes(), s.mover_of.bytes(),
        s.along_axis.bytes(), s.first_piece.bytes(), s.boxes.bytes(), s.pieces.bytes(),
        s.piece_of.bytes(), s.piece_keys.bytes(), s.pairs.footprint().total(), s.candidates.bytes(),
        s.spare.bytes(), s.chances.bytes(), s.round.bytes(), s.listed.bytes(), s.answers.bytes(),
        s.found.bytes(), s.first_time.bytes()}) {
    sum.scratch += bytes;
  }
  sum.results += s.impacts.bytes();
  sum.results += s.first.bytes();
  return sum;
}

}  // namespace winnow
