// The automatic choice of a structure: class AutomaticChoice, and the structure `automatic()`,
// whose name in reports is AutoPartition. PartitionState calls choose() and refreshed() in every
// refresh; the costs come from predicted_costs.h, the sample of the scene from sample_scene.h.

#include "partitions/choice/chooser.h"
#include "partitions/choice/predicted_costs.h"
#include "partitions/choice/sample_scene.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/structure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace winnow {
namespace {

// Factor by which a predicted cost must be lower to count as cheaper: predictions are no more
// accurate than this.
constexpr double kWorthwhile = 0.85;
// The first choice minimizes the cost of the build plus this many frames.
constexpr double kFramesAhead = 16.0;
// The sample is renewed after this many moves per object.
constexpr std::size_t kMovesToRecheck = 32;
// If fewer than one object in kQuiet moved, costs are predicted only every kQuietFrames frames.
constexpr std::size_t kQuiet = 256;
constexpr std::size_t kQuietFrames = 16;
// With at most kFew objects a frame takes little longer than predicting costs, so costs are
// predicted only every kFewFrames frames.
constexpr std::size_t kFew = 192;
constexpr std::size_t kFewFrames = 8;
// Refreshes without a choice after a memory allocation failed.
constexpr std::size_t kRefreshesAfterFailure = 64;
// With at most this many objects, brute force is chosen: any other structure would save less time
// than its prediction takes.
constexpr std::size_t kTooFew = 32;
// Limit of the count of changes away from a structure. The price of the structure doubles with each
// of these changes; at this limit, savings never reach the price.
constexpr std::uint8_t kMaxOften = 32;
// The first change to a structure that is clearly cheaper is made when the structure would have
// saved the share 1 / 2^kTrust of its price. This assumes that the scene stays as it is for eight
// times as long as until then. Each further change needs twice the share.
constexpr std::uint64_t kTrust = 3;
constexpr double kClearly = 0.75;
// kUsualBuilds: shares of refreshes with a build, for trees and for cells, that are included in the
// constants of StructureCosts. The others are weights of exponential moving averages: kRecent for
// the kind of structure in use (about the last 16 refreshes), kForgotten for the decay of the other
// kind, kNewest for new objects.
constexpr std::array<double, 2> kUsualBuilds{0.1, 0.25};
constexpr double kRecent = 1.0 / 16.0;
constexpr double kForgotten = 1.0 / 128.0;
constexpr double kNewest = 1.0 / 4.0;
// Nanoseconds to allocate the first memory of another structure.
constexpr double kExchange = 3'000.0;
// kUsualWear: wear up to this share of a frame's cost is included in the constants of
// StructureCosts. kTest: nanoseconds of a test of 16 volumes.
constexpr double kUsualWear = 0.15;
constexpr double kTest = 8.0;

bool has_cells(StructureKind kind) noexcept {
  return kind.info()->costs->has_cells;
}

bool is_brute_force(StructureKind kind) noexcept {
  return kind.info()->costs->square > 0;
}

bool differ_much(std::size_t a, std::size_t b) noexcept {
  return a > 2 * b + 64 || b > 2 * a + 64;
}

/// Chooses a structure for the rows and revises the choice at each refresh. A change costs one
/// build. Results in canonical order do not depend on the choice.
///
/// In each refresh that is not quiet (`is_quiet`), the class predicts the cost of every structure
/// from the frame's work (objects moved, pairs, rays, regions, nearest queries) and from a sample
/// of the scene (SceneFeatures, PredictedCosts). The sample is renewed only after much has moved.
/// The first choice is the cheapest prediction. Later choices are a ski rental: another structure
/// is chosen once the savings it would have made exceed the cost of its build. For the first three
/// changes an eighth, a quarter and a half of that cost suffice if the structure is clearly
/// cheaper. A structure that was replaced before must save twice as much for each time it was
/// replaced, so that a scene that alternates between two states does not alternate between two
/// structures. If cells or trees were seen to be built often, because objects are fast or many are
/// inserted, the cost of these builds is added. If an update scatters all objects, every structure
/// has to be built and a change is free. All decisions depend on counts and samples, never on time:
/// they are the same on every machine, instruction set and number of threads.
///
/// The choice changes only in refreshes that follow a change of the rows. A scene that is built
/// once and then only queried keeps its first choice. Partitions of volumes other than boxes keep
/// first().
class AutomaticChoice final : public Chooser {
 public:
  [[nodiscard]] StructureKind first() const noexcept override { return linear_bvh(); }

  [[nodiscard]] std::span<const StructureKind> choices() const noexcept override {
    return candidates();
  }
  [[nodiscard]] StructureKind choose(const Rows& rows, StructureKind now,
                                     const Wear& wear) noexcept override {
    before_ = chosen_kind_ = now;
    build_due_ = false;
    ++frames_;
    if (refreshes_to_wait_ != 0) {
      --refreshes_to_wait_;
    } else if (rows.size() != 0 && rows.pool().volume() == Volume::aabb && !is_quiet(rows)) {
      predict(rows, wear);
      frames_ = 0;
    }
    return chosen_kind_;
  }
  void refused() noexcept override { refreshes_to_wait_ = kRefreshesAfterFailure; }
  void refreshed(const Rows& rows, StructureKind now, std::uint64_t builds) noexcept override {
    if (now != before_) note_change();
    if (chosen_kind_ != before_) refreshes_in_use_ = 0;
    if (chosen_kind_ != before_ || build_due_) builds_seen_ = builds;
    changed_ = 0;
    chosen_ = rows.size() != 0;
  }
  void clear() noexcept override {
    chosen_ = false;
    saved_ = {};
    times_left_ = {};
    pairs_ = 0;
  }
  void report(StructureChoice& choice) const noexcept override {
    choice.reason = reason_;
    choice.changes = changes_;
    choice.features = features_;
  }
  [[nodiscard]] std::size_t bytes() const noexcept override { return sizeof *this; }
  void destroy(std::pmr::memory_resource* memory) noexcept override { delete_in(memory, this); }

 private:
  /// True if costs were predicted recently, and few objects moved or there are few objects: a
  /// prediction would cost more than the frame.
  [[nodiscard]] bool is_quiet(const Rows& rows) const noexcept {
    if (!chosen_ || rows.size() != objects_before_) return false;
    return (frames_ < kQuietFrames && kQuiet * changed_ < rows.size()) ||
           (frames_ < kFewFrames && rows.size() <= kFew);
  }
  [[nodiscard]] FrameWork collect_work(std::size_t live) noexcept;
  void predict(const Rows& rows, const Wear& wear) noexcept;
  void choose_first(FrameWork frame) noexcept;
  void consider(const FrameWork& frame, const Wear& wear, bool scattered) noexcept;
  void note_new_objects(const Wear& wear) noexcept;
  void note_wear(const Wear& wear, bool scattered) noexcept;
  void note_change() noexcept;
  /// Nanoseconds per frame, including builds and wear beyond the usual.
  [[nodiscard]] double cost_of(const PredictedCosts& costs, std::size_t candidate) const noexcept;

  StructureKind before_;  // the structure before this refresh, and the chosen one
  StructureKind chosen_kind_;
  SceneFeatures features_;
  // By candidate: savings not yet spent, and how often the structure was replaced.
  PredictedCosts::CostList saved_{};
  std::array<std::uint8_t, kMaxCandidates> times_left_{};
  // Moving average: share of refreshes in which an update scattered all objects.
  double scattered_share_ = 0.0;
  // Moving averages over the other refreshes, for trees and for cells: the share that built, and
  // nanoseconds per object by which queries took longer than on a fresh structure.
  std::array<double, 2> build_share_{0.0, 0.1};
  std::array<double, 2> worn_{};
  double build_share_of_new_ = 0.0;  // moving average: share that builds because of new objects
  std::uint64_t builds_seen_ = 0;    // builds of the current structure
  std::uint64_t excess_seen_ = 0;
  std::size_t refreshes_in_use_ = 0;  // refreshes with the current structure
  std::string_view reason_ = "no choice yet: the default structure";
  std::uint64_t changes_ = 0;
  std::size_t objects_seen_ = 0;          // at the last sample
  std::size_t changes_since_sample_ = 0;  // changes since the last sample
  std::size_t pairs_seen_ = 0;            // at the last sample
  std::size_t objects_before_ = 0;        // at the last prediction
  std::size_t frames_ = 0;                // refreshes since then, including this one
  // Remaining refreshes without a choice after a failed allocation.
  std::size_t refreshes_to_wait_ = 0;
  bool chosen_ = false;
  bool build_due_ = false;  // in the last refresh, for every structure
};

std::size_t number_of(StructureKind kind) noexcept {
  const auto all = candidates();
  return static_cast<std::size_t>(std::ranges::find(all, kind) - all.begin());
}

std::size_t number_of_brute_force() noexcept {
  const auto all = candidates();
  return static_cast<std::size_t>(std::ranges::find_if(all, is_brute_force) - all.begin());
}

FrameWork AutomaticChoice::collect_work(std::size_t live) noexcept {
  const auto each = [this](std::size_t count) { return (count + frames_ - 1) / frames_; };
  FrameWork frame;
  frame.changed = std::min(changed_, live);
  frame.pair_queries = each(take(QueryKind::pairs));
  frame.full_queries = each(take(QueryKind::all_pairs));
  frame.casts = each(take(QueryKind::casts));
  frame.regions = each(take(QueryKind::regions));
  frame.nearest = each(take(QueryKind::nearest));
  return frame;
}

void AutomaticChoice::predict(const Rows& rows, const Wear& wear) noexcept {
  const std::size_t live = objects_before_ = rows.size();
  const FrameWork frame = collect_work(live);
  note_new_objects(wear);
  changes_since_sample_ += frame.changed;
  const std::size_t before = features_.objects;
  if (chosen_ && live <= kTooFew && is_brute_force(before_)) {
    features_.objects = live;
    return;
  }
  const std::size_t pairs = pairs_.load(std::memory_order_relaxed);
  if (pairs_seen_ == 0) pairs_seen_ = pairs;
  // If most objects were inserted or removed, every structure needs a build.
  const bool other_scene = !chosen_ || live > 2 * before || 2 * live < before;
  if (other_scene || differ_much(live, objects_seen_) || differ_much(pairs, pairs_seen_) ||
      changes_since_sample_ / kMovesToRecheck > live) {
    features_ = sample_scene(rows.pool(), live);
    objects_seen_ = live;
    changes_since_sample_ = 0;
    pairs_seen_ = 0;
  }
  features_.objects = live;
  const bool scattered = chosen_ && !other_scene && !rows.regions().built;
  build_due_ = other_scene || scattered;
  if (other_scene) choose_first(frame);
  if (chosen_ && chosen_kind_ == before_) consider(frame, wear, scattered);
}

// The first prediction assumes that all objects move. It assumes a query for all pairs if there
// were no other queries.
void AutomaticChoice::choose_first(FrameWork frame) noexcept {
  frame.changed = features_.objects;
  if (frame.casts + frame.regions + frame.nearest == 0) frame.pair_queries = 1;
  const PredictedCosts costs(features_, frame,
                             features_.pairs * static_cast<double>(features_.objects));
  // The cost constants were fitted to scenes with more objects than kTooFew.
  const std::size_t best =
      features_.objects <= kTooFew ? number_of_brute_force() : costs.cheapest(kFramesAhead);
  if (times_left_[best] != 0) return;
  chosen_kind_ = candidates()[best];
  reason_ = is_brute_force(chosen_kind_) ? "too few objects for a structure to pay off"
                                         : "the lowest cost predicted from a sample of the scene";
}

// New objects are appended behind the sorted rows until a build is due. The first objects of a
// scene are part of its first build and do not count.
void AutomaticChoice::note_new_objects(const Wear& wear) noexcept {
  const std::size_t came = std::exchange(new_, 0);
  if (!chosen_) return;
  const auto frames = static_cast<double>(frames_);
  const double each = static_cast<double>(came) / frames;
  const double share = std::min(1.0, each / static_cast<double>(wear.max_new));
  build_share_of_new_ += std::min(1.0, kNewest * frames) * (share - build_share_of_new_);
}

// Measures how often structures are built and how much they wear. Neither can be predicted from the
// sample, which has no velocities: if objects are fast, cells and strips are built in every frame,
// and trees wear and are built. Brute force never builds, so it measures neither.
void AutomaticChoice::note_wear(const Wear& wear, bool scattered) noexcept {
  const std::size_t own = has_cells(before_) ? 1 : 0;
  const bool can_compare = !is_brute_force(before_);
  const auto frames = static_cast<double>(frames_);
  const std::uint64_t built = wear.builds - builds_seen_;
  const double builds = std::min(1.0, static_cast<double>(built) / frames);
  const std::uint64_t excess = wear.excess - (built != 0 ? 0 : std::min(excess_seen_, wear.excess));
  const double worn =
      kTest * static_cast<double>(excess) / (frames * static_cast<double>(features_.objects));
  // The first frames of a structure weigh more than later ones, but a single build must not
  // dominate.
  const double weight = std::max(kRecent, 1.0 / (3.0 + static_cast<double>(refreshes_in_use_)));
  scattered_share_ += weight * ((scattered ? 1.0 : 0.0) - scattered_share_);
  for (std::size_t kind = 0; kind < build_share_.size() && !scattered; ++kind) {
    if (can_compare && kind == own) {
      build_share_[kind] += weight * (builds - build_share_[kind]);
      worn_[kind] += weight * (worn - worn_[kind]);
    } else {
      build_share_[kind] -= kForgotten * build_share_[kind];
      worn_[kind] -= kForgotten * worn_[kind];
    }
  }
  ++refreshes_in_use_;
  builds_seen_ = wear.builds;
  excess_seen_ = wear.excess;
}

double AutomaticChoice::cost_of(const PredictedCosts& costs, std::size_t candidate) const noexcept {
  const std::size_t kind = has_cells(candidates()[candidate]) ? 1 : 0;
  const double fresh = costs.of(candidate);
  const double worn = worn_[kind] * static_cast<double>(features_.objects);
  // Motion after which trees need a build also moves objects out of their cells.
  const double builds = std::max({build_share_[kind], build_share_[0], build_share_of_new_});
  const double coherent = fresh +
                          std::max(0.0, builds - kUsualBuilds[kind]) * costs.build_of(candidate) +
                          std::max(0.0, worn - kUsualWear * fresh);
  return coherent + scattered_share_ * (costs.scattered_of(candidate) - coherent);
}

// Adds each structure's savings of this frame, and chooses the structure whose savings exceed its
// price the most.
void AutomaticChoice::consider(const FrameWork& frame, const Wear& wear, bool scattered) noexcept {
  const std::size_t pairs = pairs_.load(std::memory_order_relaxed);
  const PredictedCosts costs(features_, frame, static_cast<double>(pairs));
  note_wear(wear, scattered);
  const int trust = static_cast<int>(kTrust - std::min(kTrust, changes_));
  const std::size_t now = number_of(before_);
  const double current_cost = cost_of(costs, now);
  std::size_t best = now;
  double most = 0.0;
  for (std::size_t k = 0; k < candidates().size(); ++k) {
    const double cost = cost_of(costs, k);
    const double gain = static_cast<double>(frames_) * (kWorthwhile * current_cost - cost);
    saved_[k] = k == now ? 0.0 : std::max(0.0, saved_[k] + gain);
    const int doubled = times_left_[k] - (cost < kClearly * current_cost ? trust : 0);
    const double price = scattered ? 0.0 : std::ldexp(kExchange + costs.build_of(k), doubled);
    if (saved_[k] - price <= most) continue;
    most = saved_[k] - price;
    best = k;
  }
  if (best == now) return;
  chosen_kind_ = candidates()[best];
  const double by_queries = costs.queries_of(now) - costs.queries_of(best);
  const double by_pairs = current_cost - cost_of(costs, best) - by_queries;
  reason_ = by_queries > by_pairs ? "cheaper for the queries of the last frames"
                                  : "cheaper for moved objects and their pairs";
}

// A change resets all savings.
void AutomaticChoice::note_change() noexcept {
  saved_ = {};
  if (!chosen_) return;
  ++changes_;
  std::uint8_t& times_left = times_left_[number_of(before_)];
  if (times_left < kMaxOften) ++times_left;
}

constexpr StructureInfo kInfo{
    .name = "AutoPartition",
    .make = nullptr,
    .destroy = nullptr,
    .bytes = 0,
    .make_chooser = [](std::pmr::memory_resource* memory) noexcept -> Chooser* {
      return new_in<AutomaticChoice>(memory);
    }};

}  // namespace

StructureKind automatic() noexcept {
  return StructureKind(kInfo);
}

}  // namespace winnow
