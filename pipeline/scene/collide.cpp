#include "pipeline/scene/collision.h"

#include <utility>

namespace winnow {

Collision::Collision(Scene::State& scene, Contacts::State& contacts, SceneLevel level) noexcept
    : scene_(scene),
      contacts_(contacts),
      level_(level),
      carries_(scene.options.carry_over > 0.0 && level >= SceneLevel::distance),
      same_scene_(contacts.scene == scene.serial),
      same_level_(same_scene_ && contacts.level == level) {}

Status Collision::run() {
  if (!same_scene_) contacts_.clear();
  contacts_.scene = scene_.serial;
  contacts_.level = level_;
  contacts_.carried_count = 0;
  if (!wake_dormant() || !match()) return Status::out_of_memory;
  if (decide()) {
    if (!list_pairs()) return Status::out_of_memory;
    for (const Status status : {answer_convex(), answer_composite()}) {
      if (status != Status::ok) return status;
    }
    contacts_.frame.swap(contacts_.before);
    // The same pairs keep their records in place.
    if (!same_pairs_) {
      contacts_.records.swap(contacts_.records_before);
      contacts_.carried.swap(contacts_.carried_before);
    }
    if (!show() || !close_frame()) return Status::out_of_memory;
  }
  contacts_.clock = scene_.clock;
  contacts_.pairs_serial = scene_.pairs.serial();
  contacts_.regroupings = scene_.regroupings;
  return Status::ok;
}

// Sorts what has to be answered into convex pairs and others. `source` becomes the place in the
// list.
bool Collision::list_pairs() {
  scene_.convex.clear();
  scene_.composite.clear();
  if (level_ == SceneLevel::pairs) return true;
  const auto pairs = scene_.pairs.pairs();
  if (!contacts_.source.resize(pairs.size())) return false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto origin = static_cast<Origin>(contacts_.origin[i]);
    if (origin == Origin::carried) continue;
    Column<BodyPair>& list = origin == Origin::convex ? scene_.convex : scene_.composite;
    contacts_.source[i] = static_cast<std::uint32_t>(list.size());
    if (!list.push_back(pairs[i])) return false;
  }
  return true;
}

namespace {

[[nodiscard]] NarrowOptions narrow_options(const SceneOptions& options, SceneLevel level) noexcept {
  return {static_cast<NarrowLevel>(static_cast<int>(level) - 1), options.tier, options.margin,
          options.execution};
}

// Where the answer about each pair of the input lies.
[[nodiscard]] bool invert(const NarrowResult& answers, const Execution& execution,
                          Column<std::uint32_t>& slots) noexcept {
  constexpr std::size_t kPerTask = 8192;
  if (!slots.resize(answers.size())) return false;
  execution.for_each((answers.size() + kPerTask - 1) / kPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(answers.size(), (task + 1) * kPerTask);
    for (std::size_t i = task * kPerTask; i < end; ++i) {
      slots[answers.pair_of(i)] = static_cast<std::uint32_t>(i);
    }
  });
  return true;
}

}  // namespace

Status Collision::answer_convex() {
  if (level_ == SceneLevel::pairs || scene_.convex.empty()) return Status::ok;
  const Status status = scene_.narrow.collide(
      scene_.shapes,
      {{scene_.shape.data(), scene_.shape.size()}, {scene_.pose.data(), scene_.pose.size()}},
      {scene_.convex.data(), scene_.convex.size()}, narrow_options(scene_.options, level_),
      scene_.answers);
  if (status != Status::ok) return status;
  scene_.statistics.convex = scene_.narrow.statistics();
  return invert(scene_.answers, scene_.options.execution, scene_.slot) ? Status::ok
                                                                       : Status::out_of_memory;
}

Status Collision::answer_composite() {
  if (level_ == SceneLevel::pairs || scene_.composite.empty()) return Status::ok;
  const SceneOptions& options = scene_.options;
  PrimitivePairs& parts = scene_.parts;
  // What is farther apart than this cannot touch before its pair is made anew.
  const double reach = options.margin + (carries_ ? options.carry_over : 0.0);
  Status status = options.composites->expand(
      scene_.shapes,
      {{scene_.shape.data(), scene_.shape.size()}, {scene_.pose.data(), scene_.pose.size()}},
      {scene_.composite.data(), scene_.composite.size()}, reach, options.execution, parts);
  if (status != Status::ok) return status;
  status = scene_.parts_narrow.collide(
      parts.tables(scene_.shapes),
      {{parts.shapes.data(), parts.shapes.size()}, {parts.poses.data(), parts.poses.size()}},
      {parts.pairs.data(), parts.pairs.size()}, narrow_options(options, level_),
      scene_.parts_answers);
  if (status != Status::ok) return status;
  if (level_ >= SceneLevel::distance) {
    options.composites->smooth(scene_.shapes, parts, options.execution, scene_.parts_answers);
  }
  scene_.statistics.parts = scene_.parts_narrow.statistics();
  scene_.statistics.primitive_pairs = parts.pairs.size();
  return invert(scene_.parts_answers, options.execution, scene_.parts_slot) ? Status::ok
                                                                            : Status::out_of_memory;
}

Status Scene::collide(SceneLevel level, Contacts& contacts) {
  if (!state_->options_are_good || level > SceneLevel::manifold) return Status::invalid_argument;
  state_->statistics = {};
  Status status = state_->find_pairs();
  if (status == Status::ok) {
    state_->statistics.body_pairs = state_->pairs.pairs().size();
    status = Collision(*state_, *contacts.state_, level).run();
  }
  if (status == Status::ok) {
    state_->statistics.carried = contacts.state_->carried_count;
    state_->statistics.boxes_updated = std::exchange(state_->boxes_updated, 0);
    ++state_->clock;
  } else {
    contacts.clear();
  }
  return status;
}

}  // namespace winnow
