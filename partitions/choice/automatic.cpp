// The automatic choice of a structure.

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

// A structure that is only this much cheaper, or less, is no better: the prediction is not that
// good.
constexpr double kWorthwhile = 0.85;
// Frames like the first that the first choice is made for.
constexpr double kFramesAhead = 16.0;
// A sample is taken anew once each object has moved this often.
constexpr std::size_t kMovesToLook = 32;
// A frame is quiet where fewer than one object in so many moved: then it is thought about in one
// frame of so many.
constexpr std::size_t kQuiet = 256;
constexpr std::size_t kQuietFrames = 16;
// Of so few objects a frame takes little longer than thinking about it: that is done in one of so
// many.
constexpr std::size_t kFew = 192;
constexpr std::size_t kFewFrames = 8;
// Refreshes that pass before memory that was refused is asked for again.
constexpr std::size_t kPatience = 64;
// Objects up to which brute force cannot lose by more than thinking about it costs.
constexpr std::size_t kTooFew = 32;
// How often a structure is counted to have been left: past that its price is out of reach.
constexpr std::uint8_t kMostOften = 32;
// A first change of mind to a structure that is clearly cheaper need only have saved an eighth of
// its price: a scene that goes on like its last frames for eight times as long is the rule. Each
// further one needs twice as much.
constexpr std::uint64_t kTrust = 3;
constexpr double kClearly = 0.75;
// The share of refreshes in which trees, and cells, are built that the constants of the costs hold
// for, and about how many refreshes it is known from. That of the others is forgotten more slowly.
constexpr std::array<double, 2> kUsualBuilds{0.1, 0.25};
constexpr double kRecent = 1.0 / 16.0;
constexpr double kForgotten = 1.0 / 128.0;
constexpr double kNewest = 1.0 / 4.0;
// What the first memory of another structure costs, in nanoseconds.
constexpr double kExchange = 3'000.0;
// Wear up to this share of a frame's cost is usual. A test of 16 volumes takes so many nanoseconds.
constexpr double kUsualWear = 0.15;
constexpr double kTest = 8.0;

bool has_cells(StructureKind kind) noexcept {
  return kind.info()->costs->has_cells;
}

bool is_brute_force(StructureKind kind) noexcept {
  return kind.info()->costs->square > 0;
}

bool far_apart(std::size_t a, std::size_t b) noexcept {
  return a > 2 * b + 64 || b > 2 * a + 64;
}

/// Picks a structure for the scene it is given and goes on picking. At a refresh it may have the
/// partition exchange its structure, which costs one build and which no caller can see but by the
/// time taken; results in canonical order are the same.
///
/// What each structure would have cost is predicted in every frame from what the frame did (objects
/// moved, pairs, rays, regions and nearest objects asked for) and from a sample of the scene (see
/// SceneFeatures and PredictedCosts), which is taken anew only after much has moved. The first
/// choice is the cheapest prediction. Later ones are a ski rental: another structure is taken once
/// what it would have saved exceeds what its build costs (an eighth, a quarter and a half of that
/// for the first three changes, where it is clearly cheaper), and each structure that was left
/// before must save twice as much to come back, so that a scene that alternates does not. Cells, or
/// trees, that were seen to be built often, because objects are fast or many come, count as that
/// much dearer; where an update scatters all objects every structure has to be built, and changing
/// is free. All decisions follow counts and samples, never time: they are the same on every
/// machine, instruction set and number of threads.
///
/// It changes only where something changed since the last refresh. A world that is built once and
/// only asked from then on keeps its first choice; volumes other than boxes stay with the structure
/// that it begins with.
class AutomaticChoice final : public Chooser {
 public:
  [[nodiscard]] StructureKind first() const noexcept override { return linear_bvh(); }

  [[nodiscard]] std::span<const StructureKind> range() const noexcept override {
    return candidates();
  }
  [[nodiscard]] StructureKind choose(const Rows& rows, StructureKind now,
                                     const Wear& wear) noexcept override {
    before_ = wanted_ = now;
    build_due_ = false;
    ++frames_;
    if (waiting_ != 0) {
      --waiting_;
    } else if (rows.size() != 0 && rows.pool().volume() == Volume::aabb && !is_quiet(rows)) {
      look(rows, wear);
      frames_ = 0;
    }
    return wanted_;
  }
  void refused() noexcept override { waiting_ = kPatience; }
  void refreshed(const Rows& rows, StructureKind now, std::uint64_t builds) noexcept override {
    if (now != before_) note_change();
    if (wanted_ != before_) held_ = 0;
    if (wanted_ != before_ || build_due_) builds_seen_ = builds;
    changed_ = 0;
    chosen_ = rows.size() != 0;
  }
  void clear() noexcept override {
    chosen_ = false;
    saved_ = {};
    left_ = {};
    pairs_ = 0;
  }
  void report(StructureChoice& choice) const noexcept override {
    choice.reason = reason_;
    choice.changes = changes_;
    choice.features = features_;
  }
  [[nodiscard]] std::size_t bytes() const noexcept override { return sizeof *this; }
  void end(std::pmr::memory_resource* memory) noexcept override { delete_in(memory, this); }

 private:
  /// True where hardly anything moved, or hardly anything is there, and it was thought about not
  /// long ago: thinking would cost more than the frame.
  [[nodiscard]] bool is_quiet(const Rows& rows) const noexcept {
    if (!chosen_ || rows.size() != objects_before_) return false;
    return (frames_ < kQuietFrames && kQuiet * changed_ < rows.size()) ||
           (frames_ < kFewFrames && rows.size() <= kFew);
  }
  [[nodiscard]] FrameWork take_frame(std::size_t live) noexcept;
  void look(const Rows& rows, const Wear& wear) noexcept;
  void guess(FrameWork frame) noexcept;
  void consider(const FrameWork& frame, const Wear& wear, bool scattered) noexcept;
  void note_new_objects(const Wear& wear) noexcept;
  void note_wear(const Wear& wear, bool scattered) noexcept;
  void note_change() noexcept;
  /// With builds and wear beyond the usual.
  [[nodiscard]] double cost_of(const PredictedCosts& costs, std::size_t candidate) const noexcept;

  StructureKind before_;  // of this refresh: what was there, and what is chosen
  StructureKind wanted_;
  SceneFeatures features_;
  // By candidate: what it would have saved, not yet spent, and how often it was left.
  PredictedCosts::List saved_{};
  std::array<std::uint8_t, kMostCandidates> left_{};
  // About how many refreshes there are in which an update scattered all.
  double scattered_share_ = 0.0;
  // Of the others, with trees and with cells: about how many built them, and what queries took
  // longer than on fresh ones, in nanoseconds per object.
  std::array<double, 2> build_share_{0.0, 0.1};
  std::array<double, 2> worn_{};
  double build_share_of_new_ = 0.0;  // about how many build because so many are new
  std::uint64_t builds_seen_ = 0;    // by the structure that is there
  std::uint64_t excess_seen_ = 0;
  std::size_t held_ = 0;  // refreshes by it, up to a limit
  std::string_view reason_ = "nothing to choose by yet";
  std::uint64_t changes_ = 0;
  std::size_t objects_seen_ = 0;    // when the sample was taken
  std::size_t unseen_ = 0;          // changes since the last sample
  std::size_t pairs_seen_ = 0;      // pairs when the sample was taken
  std::size_t objects_before_ = 0;  // at the last look
  std::size_t frames_ = 0;          // refreshes since then, this one included
  std::size_t waiting_ = 0;         // refreshes to wait after memory was refused
  bool chosen_ = false;
  bool build_due_ = false;  // in the last refresh, whatever was chosen
};

std::size_t number_of(StructureKind kind) noexcept {
  const auto all = candidates();
  return static_cast<std::size_t>(std::ranges::find(all, kind) - all.begin());
}

std::size_t number_of_brute_force() noexcept {
  const auto all = candidates();
  return static_cast<std::size_t>(std::ranges::find_if(all, is_brute_force) - all.begin());
}

FrameWork AutomaticChoice::take_frame(std::size_t live) noexcept {
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

void AutomaticChoice::look(const Rows& rows, const Wear& wear) noexcept {
  const std::size_t live = objects_before_ = rows.size();
  const FrameWork frame = take_frame(live);
  note_new_objects(wear);
  unseen_ += frame.changed;
  const std::size_t before = features_.objects;
  if (chosen_ && live <= kTooFew && is_brute_force(before_)) {
    features_.objects = live;
    return;
  }
  const std::size_t pairs = pairs_.load(std::memory_order_relaxed);
  if (pairs_seen_ == 0) pairs_seen_ = pairs;
  // Where most objects came or went a build is due whatever is chosen.
  const bool other_scene = !chosen_ || live > 2 * before || 2 * live < before;
  if (other_scene || far_apart(live, objects_seen_) || far_apart(pairs, pairs_seen_) ||
      unseen_ / kMovesToLook > live) {
    features_ = sample_scene(rows.pool(), live);
    objects_seen_ = live;
    unseen_ = 0;
    pairs_seen_ = 0;
  }
  features_.objects = live;
  const bool scattered = chosen_ && !other_scene && !rows.regions().built;
  build_due_ = other_scene || scattered;
  if (other_scene) guess(frame);
  if (chosen_ && wanted_ == before_) consider(frame, wear, scattered);
}

// As if everything moved and all pairs were wanted, unless something else was asked for.
void AutomaticChoice::guess(FrameWork frame) noexcept {
  frame.changed = features_.objects;
  if (frame.casts + frame.regions + frame.nearest == 0) frame.pair_queries = 1;
  const PredictedCosts costs(features_, frame,
                             features_.pairs * static_cast<double>(features_.objects));
  // The costs are known of more objects.
  const std::size_t best =
      features_.objects <= kTooFew ? number_of_brute_force() : costs.cheapest(kFramesAhead);
  if (left_[best] != 0) return;
  wanted_ = candidates()[best];
  reason_ = is_brute_force(wanted_) ? "so few objects that no structure pays"
                                    : "the least cost expected from a sample of the scene";
}

// What comes stands behind the rows in order until there are so many that a build is due. The first
// objects of a scene are part of its first build.
void AutomaticChoice::note_new_objects(const Wear& wear) noexcept {
  const std::size_t came = std::exchange(new_, 0);
  if (!chosen_) return;
  const auto frames = static_cast<double>(frames_);
  const double each = static_cast<double>(came) / frames;
  const double share = std::min(1.0, each / static_cast<double>(wear.most_new));
  build_share_of_new_ += std::min(1.0, kNewest * frames) * (share - build_share_of_new_);
}

// Where objects are fast, cells and strips are built in every frame, and trees wear and are built,
// which nothing that is known of the scene tells beforehand. Brute force tells nothing of either.
void AutomaticChoice::note_wear(const Wear& wear, bool scattered) noexcept {
  const std::size_t own = has_cells(before_) ? 1 : 0;
  const bool tells = !is_brute_force(before_);
  const auto frames = static_cast<double>(frames_);
  const std::uint64_t built = wear.builds - builds_seen_;
  const double builds = std::min(1.0, static_cast<double>(built) / frames);
  const std::uint64_t excess = wear.excess - (built != 0 ? 0 : std::min(excess_seen_, wear.excess));
  const double worn =
      kTest * static_cast<double>(excess) / (frames * static_cast<double>(features_.objects));
  // The first frames of a structure tell more than later ones, but one build is no habit.
  const double weight = std::max(kRecent, 1.0 / (3.0 + static_cast<double>(held_)));
  scattered_share_ += weight * ((scattered ? 1.0 : 0.0) - scattered_share_);
  for (std::size_t kind = 0; kind < build_share_.size() && !scattered; ++kind) {
    if (tells && kind == own) {
      build_share_[kind] += weight * (builds - build_share_[kind]);
      worn_[kind] += weight * (worn - worn_[kind]);
    } else {
      build_share_[kind] -= kForgotten * build_share_[kind];
      worn_[kind] -= kForgotten * worn_[kind];
    }
  }
  held_ += held_ < kPatience ? 1 : 0;
  builds_seen_ = wear.builds;
  excess_seen_ = wear.excess;
}

double AutomaticChoice::cost_of(const PredictedCosts& costs, std::size_t candidate) const noexcept {
  const std::size_t kind = has_cells(candidates()[candidate]) ? 1 : 0;
  const double fresh = costs.of(candidate);
  const double worn = worn_[kind] * static_cast<double>(features_.objects);
  // What makes trees be built makes objects leave cells.
  const double builds = std::max({build_share_[kind], build_share_[0], build_share_of_new_});
  const double coherent = fresh +
                          std::max(0.0, builds - kUsualBuilds[kind]) * costs.build_of(candidate) +
                          std::max(0.0, worn - kUsualWear * fresh);
  return coherent + scattered_share_ * (costs.scattered_of(candidate) - coherent);
}

// What each structure would have saved is summed up until it pays for a part of the build.
void AutomaticChoice::consider(const FrameWork& frame, const Wear& wear, bool scattered) noexcept {
  const std::size_t pairs = pairs_.load(std::memory_order_relaxed);
  const PredictedCosts costs(features_, frame, static_cast<double>(pairs));
  note_wear(wear, scattered);
  const int trust = static_cast<int>(kTrust - std::min(kTrust, changes_));
  const std::size_t now = number_of(before_);
  const double held = cost_of(costs, now);
  std::size_t best = now;
  double most = 0.0;
  for (std::size_t k = 0; k < candidates().size(); ++k) {
    const double cost = cost_of(costs, k);
    const double gain = static_cast<double>(frames_) * (kWorthwhile * held - cost);
    saved_[k] = k == now ? 0.0 : std::max(0.0, saved_[k] + gain);
    const int doubled = left_[k] - (cost < kClearly * held ? trust : 0);
    const double price = scattered ? 0.0 : std::ldexp(kExchange + costs.build_of(k), doubled);
    if (saved_[k] - price <= most) continue;
    most = saved_[k] - price;
    best = k;
  }
  if (best == now) return;
  wanted_ = candidates()[best];
  const double by_queries = costs.queries_of(now) - costs.queries_of(best);
  const double by_pairs = held - cost_of(costs, best) - by_queries;
  reason_ = by_queries > by_pairs ? "cheaper for the queries that are asked"
                                  : "cheaper for what moves and for its pairs";
}

// What has been paid for is spent.
void AutomaticChoice::note_change() noexcept {
  saved_ = {};
  if (!chosen_) return;
  ++changes_;
  std::uint8_t& left = left_[number_of(before_)];
  if (left < kMostOften) ++left;
}

constexpr StructureInfo kInfo{
    .name = "AutoPartition",
    .make = nullptr,
    .end = nullptr,
    .bytes = 0,
    .make_chooser = [](std::pmr::memory_resource* memory) noexcept -> Chooser* {
      return new_in<AutomaticChoice>(memory);
    }};

}  // namespace

StructureKind automatic() noexcept {
  return StructureKind(kInfo);
}

}  // namespace winnow
