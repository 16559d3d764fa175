#include "partitions/choice/auto_partition.h"

#include "partitions/structures/brute_force/bounds_n_squared.h"
#include "partitions/structures/bvh/linear_bvh.h"
#include "partitions/structures/bvh/static_bvh.h"
#include "partitions/structures/grid/flat_grid.h"
#include "partitions/structures/levels/hierarchical_grid.h"
#include "partitions/structures/sweep/sweep_and_prune.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>

namespace winnow {
namespace {

// A kind that is only this much cheaper, or less, is no better: the prediction is not that good.
constexpr double kWorthwhile = 0.95;
// Frames like the first that the first choice is made for.
constexpr double kFramesAhead = 16.0;
// A sample is taken anew once each object has moved this often.
constexpr std::size_t kMovesToLook = 32;
// Refreshes that pass before memory that was refused is asked for again.
constexpr std::size_t kPatience = 64;
// Objects up to which brute force cannot lose by more than thinking about it costs.
constexpr std::size_t kTooFew = 32;
// How often a kind is counted to have been left: past that its price is out of reach.
constexpr std::uint8_t kMostOften = 32;
// A first change of mind to a kind that is clearly cheaper need only have saved an eighth of its
// price: a scene that goes on like its last frames for eight times as long is the rule. Each
// further one needs twice as much.
constexpr std::uint64_t kTrust = 3;
constexpr double kClearly = 0.75;
// The share of refreshes in which cells are built that the constants of the costs hold for, and
// about how many refreshes it is known from. It is forgotten more slowly once trees are used.
constexpr double kUsualBuilds = 0.25;
constexpr double kRecent = 1.0 / 16.0;
constexpr double kForgotten = 1.0 / 128.0;

template <typename T>
RowPartition* make(void* place, const PartitionOptions& options) {
  return ::new (place) T(options);
}

using Maker = RowPartition* (*)(void* place, const PartitionOptions& options);
// By PartitionKind.
constexpr std::array<Maker, kPartitionKinds> kMakers{make<BoundsNSquared>, make<SweepAndPrune>,
                                                     make<FlatGrid>,       make<HierarchicalGrid>,
                                                     make<LinearBvh>,      make<StaticBvh>};

bool has_cells(PartitionKind kind) noexcept {
  return kind == PartitionKind::sweep_and_prune || kind == PartitionKind::flat_grid ||
         kind == PartitionKind::hierarchical_grid;
}

bool far_apart(std::size_t a, std::size_t b) noexcept {
  return 2 * a > 3 * b + 64 || 2 * b > 3 * a + 64;
}

}  // namespace

AutoPartition::AutoPartition(const PartitionOptions& options) : options_(options) {
  static_assert(std::max({sizeof(BoundsNSquared), sizeof(SweepAndPrune), sizeof(FlatGrid),
                          sizeof(HierarchicalGrid), sizeof(LinearBvh), sizeof(StaticBvh)}) <=
                kRoom);
  move_in(PartitionKind::linear_bvh);
}

AutoPartition::~AutoPartition() {
  std::destroy_at(inner_);
}

// Makes an empty partition in the place that is free and has it hold the objects.
void AutoPartition::move_in(PartitionKind kind) noexcept {
  place_ = 1 - place_;
  inner_ = kMakers[static_cast<std::size_t>(kind)](places_[place_].bytes, options_);
  kind_ = kind;
}

Status AutoPartition::refresh() const {
  if (!stale_.load(std::memory_order_acquire)) return Status::ok;
  const std::lock_guard lock(mutex_);
  if (!stale_.load(std::memory_order_relaxed)) return Status::ok;
  // Which partition holds the objects is no more of a change that a caller can see than the
  // partition's own structure is.
  const Status status = const_cast<AutoPartition*>(this)->refresh_now();
  if (status == Status::ok) stale_.store(false, std::memory_order_release);
  return status;
}

Status AutoPartition::refresh_now() {
  const PartitionKind kind_before = wanted_ = kind_;
  if (waiting_ != 0) {
    --waiting_;
  } else if (inner_->size() != 0 && inner_->volume() == Volume::aabb) {
    choose();
  }
  const Status status = wanted_ == kind_ ? inner_->refresh() : hand_over();
  if (status != Status::ok) return status;
  if (wanted_ != kind_before) held_ = 0;
  if (wanted_ != kind_before || build_due_) builds_seen_ = inner_->statistics().builds;
  changed_ = 0;
  chosen_ = inner_->size() != 0;
  return Status::ok;
}

FrameWork AutoPartition::take_frame() noexcept {
  FrameWork frame;
  frame.changed = std::min(changed_, inner_->size());
  frame.pair_queries = pair_queries_.take();
  frame.full_queries = full_queries_.take();
  frame.casts = casts_.take();
  frame.regions = regions_.take();
  frame.nearest = nearest_.take();
  return frame;
}

void AutoPartition::choose() noexcept {
  const FrameWork frame = take_frame();
  unseen_ += frame.changed;
  const std::size_t live = inner_->size();
  const std::size_t before = features_.objects;
  if (chosen_ && live <= kTooFew && kind_ == PartitionKind::bounds_n_squared) {
    features_.objects = live;
    return;
  }
  const std::size_t pairs = pairs_.load(std::memory_order_relaxed);
  if (pairs_seen_ == 0) pairs_seen_ = pairs;
  // Where most objects came or went a build is due whatever is chosen.
  const bool other_scene = !chosen_ || live > 2 * before || 2 * live < before;
  if (other_scene || far_apart(live, objects_seen_) || far_apart(pairs, pairs_seen_) ||
      unseen_ / kMovesToLook > live) {
    features_ = SceneFeatures(inner_->pool(), live);
    objects_seen_ = live;
    unseen_ = 0;
    pairs_seen_ = 0;
  }
  features_.objects = live;
  build_due_ = other_scene;
  if (other_scene) guess(frame);
  if (chosen_ && wanted_ == kind_) consider(frame);
}

// As if everything moved and all pairs were wanted, unless something else was asked for.
void AutoPartition::guess(FrameWork frame) noexcept {
  frame.changed = features_.objects;
  if (frame.casts + frame.regions + frame.nearest == 0) frame.pair_queries = 1;
  const PartitionCosts costs(features_, frame,
                             features_.pairs * static_cast<double>(features_.objects));
  const PartitionKind best = costs.cheapest(kFramesAhead);
  if (left_[static_cast<std::size_t>(best)] != 0) return;
  wanted_ = best;
  reason_ = best == PartitionKind::bounds_n_squared
                ? "so few objects that no structure pays"
                : "the least cost expected from a sample of the scene";
}

// Where objects are too fast for cells and strips these are built in every frame, which nothing
// that is known of the scene tells beforehand. Trees wear slowly.
void AutoPartition::note_builds() noexcept {
  const std::uint64_t builds = inner_->statistics().builds;
  if (has_cells(kind_)) {
    // The first frames of a kind tell more than later ones, but one build is no habit.
    const double weight = std::max(kRecent, 1.0 / (3.0 + static_cast<double>(held_)));
    build_share_ += weight * ((builds != builds_seen_ ? 1.0 : 0.0) - build_share_);
  } else {
    build_share_ -= kForgotten * build_share_;
  }
  held_ += held_ < kPatience ? 1 : 0;
  builds_seen_ = builds;
}

double AutoPartition::cost_of(const PartitionCosts& costs, PartitionKind kind) const noexcept {
  const double unusual = has_cells(kind) ? std::max(0.0, build_share_ - kUsualBuilds) : 0.0;
  return costs.of(kind) + unusual * costs.build_of(kind);
}

// What each kind would have saved is summed up until it pays for a part of the build.
void AutoPartition::consider(const FrameWork& frame) noexcept {
  const std::size_t pairs = pairs_.load(std::memory_order_relaxed);
  const PartitionCosts costs(features_, frame, static_cast<double>(pairs));
  note_builds();
  const int trust = static_cast<int>(kTrust - std::min(kTrust, switches_));
  const double held = cost_of(costs, kind_);
  double most = 0.0;
  for (std::size_t k = 0; k < kPartitionKinds; ++k) {
    const auto kind = static_cast<PartitionKind>(k);
    const double cost = cost_of(costs, kind);
    const double gain = kWorthwhile * held - cost;
    saved_[k] = kind == kind_ ? 0.0 : std::max(0.0, saved_[k] + gain);
    const double price =
        std::ldexp(costs.build_of(kind), left_[k] - (cost < kClearly * held ? trust : 0));
    if (saved_[k] - price <= most) continue;
    most = saved_[k] - price;
    wanted_ = kind;
  }
  if (wanted_ == kind_) return;
  const double by_queries = costs.queries_of(kind_) - costs.queries_of(wanted_);
  const double by_pairs = held - cost_of(costs, wanted_) - by_queries;
  reason_ = by_queries > by_pairs ? "cheaper for the queries that are asked"
                                  : "cheaper for what moves and for its pairs";
}

Status AutoPartition::hand_over() {
  RowPartition* const before = inner_;
  const PartitionKind kind_before = kind_;
  move_in(wanted_);
  inner_->swap_objects(*before);
  const Status status = inner_->refresh();
  if (status != Status::ok) {
    before->swap_objects(*inner_);
    std::destroy_at(inner_);
    inner_ = before;
    place_ = 1 - place_;
    kind_ = kind_before;
    waiting_ = kPatience;
    return inner_->refresh();
  }
  std::destroy_at(before);
  saved_ = {};
  if (!chosen_) return Status::ok;
  ++switches_;
  std::uint8_t& left = left_[static_cast<std::size_t>(kind_before)];
  if (left < kMostOften) ++left;
  return Status::ok;
}

}  // namespace winnow
