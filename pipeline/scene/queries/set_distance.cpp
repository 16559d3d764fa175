// SceneQueries on two bodies or two sets of bodies: distance, overlaps and any_contact. The boxes
// in the partitions select pairs; shape_distance.h tests them.

#include <winnow/core/volumes.h>
#include "core/numbers/rounding.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/queries/body_distance.h"
#include "pipeline/scene/queries/box_gaps.kernel.h"
#include "pipeline/scene/queries/observed_filter.h"
#include "pipeline/scene/queries/queries.h"

#include <cmath>

namespace winnow {

WINNOW_DEFINE_KERNELS(BoxGapsKernels, box_gaps_kernels)

namespace {

/// Covers the rounding of squared box distances (three squares of float differences) and the error
/// of the solver's distance to a box boundary.
constexpr double kSquareSlack = 1e-5;

[[nodiscard]] Aabb box_of(const SceneState& scene, std::uint32_t body) noexcept {
  return scene.set(scene.body_state[body]).partition->bounds(scene.place[body]);
}

/// The boxes of a set of bodies, and their distances from other boxes. Uses the boxes in the
/// partitions, which contain the bodies.
class SetBoxes {
 public:
  explicit SetBoxes(QueryState& state) noexcept : state_(state) {}

  /// Returns false if memory is refused.
  [[nodiscard]] bool take(std::span<const Key> keys) noexcept {
    constexpr std::size_t kLanes = 16;
    count_ = keys.size();
    const std::size_t whole = (count_ + kLanes - 1) / kLanes * kLanes;
    if (!state_.bounds.resize(6 * whole) || !state_.gaps.resize(whole)) return false;
    float* column[6];
    for (std::size_t k = 0; k < 6; ++k) {
      column[k] = state_.bounds.data() + k * whole;
      bounds_[k] = column[k];
      std::fill(column[k] + count_, column[k] + whole, 0.0F);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const Aabb box = box_of(state_.scene, keys[i].id);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        column[axis][i] = box.min[axis];
        column[3 + axis][i] = box.max[axis];
      }
    }
    return true;
  }
  /// Returns lower bounds on the squared distances of the set's bodies from a body.
  [[nodiscard]] std::span<const float> squared_gaps(Key from) noexcept {
    const Aabb box = box_of(state_.scene, from.id);
    const float low[3] = {box.min[0], box.min[1], box.min[2]};
    const float high[3] = {box.max[0], box.max[1], box.max[2]};
    box_gaps_kernels().squared(bounds_, count_, low, high, state_.gaps.data());
    return {state_.gaps.data(), count_};
  }

 private:
  QueryState& state_;
  const float* bounds_[6] = {};
  std::size_t count_ = 0;
};

[[nodiscard]] bool do_rules_take(const SceneState& scene, PairRules rules, std::uint32_t a,
                                 std::uint32_t b) noexcept {
  return rules == PairRules::none || scene.accepts_pair(a, b);
}

/// Pairs of bodies of two sets that the rules accept, except pairs of a body with itself.
class SetPairs {
 public:
  SetPairs(QueryState& state, std::span<const Key> a, std::span<const Key> b,
           PairRules rules) noexcept
      : scene_(state.scene), a_(a), b_(b), rules_(rules), boxes_(state) {}

  [[nodiscard]] bool find_boxes() noexcept { return boxes_.take(b_); }
  [[nodiscard]] bool is_one_set() const noexcept {
    return a_.data() == b_.data() && a_.size() == b_.size();
  }

  /// Returns the pair with the nearest boxes, if their distance is at most `most`.
  [[nodiscard]] KeyPair nearest(double most) noexcept {
    KeyPair found;
    double least = square_of(most);
    for (const Key a : a_) {
      const std::span<const float> gaps = boxes_.squared_gaps(a);
      for (std::size_t i = 0; i < gaps.size(); ++i) {
        const auto gap = static_cast<double>(gaps[i]);
        if (!(gap < least || (gap == least && found.first == Key{}))) continue;
        if (!takes(a, b_[i])) continue;
        least = gap;
        found = {a, b_[i]};
      }
    }
    return found;
  }

  /// Calls test(body of a, body of b) for pairs whose boxes are at most most() apart, until a call
  /// returns false; most() may decrease meanwhile. With `once`, and if both sets are the same, each
  /// pair occurs once.
  template <typename Most, typename Test>
  void each_within(Most&& most, Test&& test, bool once = false) {
    double least = square_of(most());
    const bool skips = once && is_one_set();
    for (std::size_t k = 0; k < a_.size(); ++k) {
      const Key a = a_[k];
      const std::span<const float> gaps = boxes_.squared_gaps(a);
      for (std::size_t i = skips ? k + 1 : 0; i < gaps.size(); ++i) {
        if (!(static_cast<double>(gaps[i]) <= least) || !takes(a, b_[i])) continue;
        if (!test(a, b_[i])) return;
        least = square_of(most());
      }
    }
  }

 private:
  [[nodiscard]] bool takes(Key a, Key b) const noexcept {
    return a != b && do_rules_take(scene_, rules_, a.id, b.id);
  }
  [[nodiscard]] static double square_of(double gap) noexcept {
    return gap * gap * (1.0 + kSquareSlack);
  }

  const SceneState& scene_;
  std::span<const Key> a_;
  std::span<const Key> b_;
  PairRules rules_;
  SetBoxes boxes_;
};

/// True if two bodies overlap, or are at most `contact_margin` apart. The test for overlap comes
/// first, because its result is exact: a pair that is in contact at margin 0 is in contact at every
/// larger margin.
[[nodiscard]] bool are_near(const QueryState& state, std::uint32_t a, std::uint32_t b,
                            double contact_margin) noexcept {
  const PlacedShape first = state.placed(a);
  const PlacedShape second = state.placed(b);
  std::uint32_t part = kWholeShape;
  if (do_overlap(state.parts, first, second, part)) return true;
  ShapeDistance found;
  return contact_margin > 0.0 &&
         ClosestParts(state.parts).find(first, second, contact_margin, found);
}

/// Tests the bodies of the scene in the order of ids, up to the first body that has a contact.
/// Bodies with smaller ids have no contacts, so pairs with these bodies need no test.
class ContactOfBody {
 public:
  ContactOfBody(QueryState& state, double contact_margin, PairRules rules) noexcept
      : state_(state), contact_margin_(contact_margin), rules_(rules) {}

  /// True if bodies of this state are tested one after the other: every pair contains one of them.
  [[nodiscard]] bool is_searched(BodyState body_state) const noexcept {
    return rules_ == PairRules::none || body_state == BodyState::dynamic;
  }

  /// Sets `other` to the body with the least id that is in contact with `body`, or to kNoObject if
  /// there is none.
  [[nodiscard]] Status find(std::uint32_t body, std::uint32_t& other) {
    const SceneState& scene = state_.scene;
    std::uint32_t least = kNoObject;
    auto test = [&](std::uint32_t next) {
      const bool was_searched = next <= body && is_searched(scene.body_state[next]);
      if (was_searched || next >= least || !do_rules_take(scene, rules_, body, next)) return false;
      if (are_near(state_, body, next, contact_margin_)) least = next;
      return false;
    };
    SceneFilter filter;
    if (rules_ == PairRules::scene) {
      // Lets the partitions skip subtrees of bodies that the filters exclude.
      const ObjectFilter own = scene.filter_of(body);
      filter = {.layers = own.layers, .mask = own.mask, .environment = own.environment};
    }
    BodyCandidateFilter body_filter(scene, filter, test);
    const Aabb box = reach_of(body);
    const Status status = state_.each_partition([&](const Partition& partition) {
      return partition.overlap(box, state_.objects, body_filter.filter());
    });
    if (status == Status::ok) other = least;
    return status;
  }

 private:
  /// Grows the body's box by the margin and the error bound of the solver's distance to a box
  /// boundary.
  [[nodiscard]] Aabb reach_of(std::uint32_t body) const noexcept {
    const Aabb box = box_of(state_.scene, body);
    const double reach = contact_margin_ * (1.0 + 1e-9);
    Aabb wide;
    for (int axis = 0; axis < 3; ++axis) {
      wide.min[axis] = round_down(add_down(static_cast<double>(box.min[axis]), -reach));
      wide.max[axis] = round_up(add_up(static_cast<double>(box.max[axis]), reach));
    }
    return wide;
  }

  QueryState& state_;
  double contact_margin_;
  PairRules rules_;
};

/// Finds the closest pair of two sets. Starts with the pair whose boxes are nearest: few other
/// pairs have boxes that are nearer than these two bodies are.
class ClosestBodies {
 public:
  ClosestBodies(QueryState& state, double limit) noexcept : state_(state), limit_(limit) {}

  [[nodiscard]] SetDistance find(SetPairs& pairs) {
    const KeyPair nearest = pairs.nearest(reach());
    if (nearest.first == Key{}) return best_;
    test(nearest.first, nearest.second);
    pairs.each_within([&] { return reach(); },
                      [&](Key a, Key b) {
                        test(a, b);
                        return true;
                      });
    return best_;
  }

 private:
  /// Never negative, because overlapping boxes may have bodies of any depth.
  [[nodiscard]] double reach() const noexcept { return std::max(limit_, 0.0); }

  /// If distances are equal, the pair that is first in the order of ids is kept.
  void test(Key a, Key b) noexcept {
    ShapeDistance found;
    ClosestParts parts(state_.parts);
    if (!parts.find(state_.placed(a.id), state_.placed(b.id), limit_, found)) return;
    const std::pair ids(a.id, b.id);
    if (best_ && found.distance == limit_ && std::pair(best_.a.id, best_.to.key.id) <= ids) return;
    best_ = {a, state_.scene.keys.client_data(a.id), distance_to(state_.scene, b.id, found)};
    limit_ = found.distance;
  }

  QueryState& state_;
  double limit_;
  SetDistance best_;
};

[[nodiscard]] Status check_sets(const QueryState* state, std::span<const Key> a,
                                std::span<const Key> b, PairRules rules) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) return status;
  if (rules > PairRules::none) return Status::invalid_argument;
  const auto is_there = [&](Key key) { return state->scene.keys.is_valid(key); };
  const bool all =
      std::all_of(a.begin(), a.end(), is_there) && std::all_of(b.begin(), b.end(), is_there);
  return all ? Status::ok : Status::invalid_key;
}

[[nodiscard]] bool is_contact_margin(double contact_margin) noexcept {
  return contact_margin >= 0.0 && std::isfinite(contact_margin);
}

}  // namespace

Answer<SceneDistance> SceneQueries::distance(Key a, Key b, double limit, PairRules rules) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check_sets(state_, {&a, 1}, {&b, 1}, rules); status != Status::ok) {
    return status;
  }
  if (std::isnan(limit)) return Status::invalid_argument;
  ShapeDistance shapes;
  SceneDistance found;
  if (do_rules_take(state_->scene, rules, a.id, b.id) &&
      ClosestParts(state_->parts).find(state_->placed(a.id), state_->placed(b.id), limit, shapes)) {
    found = distance_to(state_->scene, b.id, shapes);
  }
  if (state_->observer != nullptr) state_->observer->distance(a, b, limit, rules, found);
  return found;
}

Answer<SetDistance> SceneQueries::least_distance(std::span<const Key> a, std::span<const Key> b,
                                                 double limit, PairRules rules) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check_sets(state_, a, b, rules); status != Status::ok) return status;
  if (std::isnan(limit)) return Status::invalid_argument;
  SetPairs pairs(*state_, a, b, rules);
  if (!pairs.find_boxes()) return Status::out_of_memory;
  const SetDistance found = ClosestBodies(*state_, limit).find(pairs);
  if (state_->observer != nullptr) state_->observer->least_distance(a, b, limit, rules, found);
  return found;
}

Answer<std::span<const KeyPair>> SceneQueries::overlaps(std::span<const Key> a,
                                                        std::span<const Key> b, std::size_t most,
                                                        PairRules rules) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check_sets(state_, a, b, rules); status != Status::ok) return status;
  Column<KeyPair>& found = state_->overlapping;
  found.clear();
  SetPairs all(*state_, a, b, rules);
  bool has_room = all.find_boxes();
  const auto test = [&](Key first, Key second) {
    std::uint32_t part = kWholeShape;
    if (do_overlap(state_->parts, state_->placed(first.id), state_->placed(second.id), part)) {
      has_room = found.push_back({first, second});
    }
    return has_room && found.size() < most;
  };
  if (has_room && most != 0) all.each_within([] { return 0.0; }, test);
  if (!has_room) return Status::out_of_memory;
  const std::span<const KeyPair> pairs(found.data(), found.size());
  if (state_->observer != nullptr) state_->observer->overlaps(a, b, most, rules, pairs);
  return pairs;
}

Answer<KeyPair> SceneQueries::any_contact(std::span<const Key> a, std::span<const Key> b,
                                          double contact_margin, PairRules rules) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check_sets(state_, a, b, rules); status != Status::ok) return status;
  if (!is_contact_margin(contact_margin)) return Status::invalid_argument;
  SetPairs all(*state_, a, b, rules);
  if (!all.find_boxes()) return Status::out_of_memory;
  KeyPair found;
  const auto test = [&](Key first, Key second) {
    if (!are_near(*state_, first.id, second.id, contact_margin)) return true;
    found = {first, second};
    return false;
  };
  all.each_within([&] { return contact_margin; }, test, true);
  if (state_->observer != nullptr)
    state_->observer->any_contact(a, b, contact_margin, rules, found);
  return found;
}

Answer<KeyPair> SceneQueries::any_contact(double contact_margin, PairRules rules) {
  const DefaultFloatEnvironment environment;
  if (const Status status = check_sets(state_, {}, {}, rules); status != Status::ok) return status;
  if (!is_contact_margin(contact_margin)) return Status::invalid_argument;
  const SceneState& scene = state_->scene;
  ContactOfBody contact(*state_, contact_margin, rules);
  KeyPair found;
  for (std::uint32_t body = 0; body < scene.keys.slot_count() && !found; ++body) {
    if (!scene.keys.is_live(body) || !contact.is_searched(scene.body_state[body])) continue;
    std::uint32_t other = kNoObject;
    if (const Status status = contact.find(body, other); status != Status::ok) return status;
    if (other != kNoObject) found = {scene.keys.key_of(body), scene.keys.key_of(other)};
  }
  if (state_->observer != nullptr) state_->observer->any_contact(contact_margin, rules, found);
  return found;
}

}  // namespace winnow
