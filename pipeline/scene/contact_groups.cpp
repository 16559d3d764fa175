// Scene::islands and Scene::colours: groups of contacts for parallel solvers. Islands use
// union-find over the bodies of every pair; colours are assigned greedily in the order of pairs.

#include <winnow/pipeline/contact_groups.h>

#include "core/memory/columns.h"
#include "core/sort/counting_sort.h"
#include "core/sort/parallel_ranges.h"
#include "core/threads/atomic_ref.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerJoin = 4096;

/// Concurrent union-find of bodies: each body points to a body with a smaller number or is the root
/// of its set. The root is the smallest number of the set, so it does not depend on the order of
/// joins (Anderson and Woll, "Wait-free parallel algorithms for the union-find problem", 1991).
class BodySets {
 public:
  explicit BodySets(Column<std::uint32_t>& towards) noexcept : towards_(towards) {
    std::iota(towards.begin(), towards.end(), 0U);
  }

  [[nodiscard]] std::uint32_t first_of(std::uint32_t body) const noexcept {
    for (std::uint32_t next = at(body).load(); next != body; next = at(body).load()) {
      const std::uint32_t after = at(next).load();
      if (after != next) at(body).compare_exchange_weak(next, after);
      body = after;
    }
    return body;
  }

  void join(std::uint32_t a, std::uint32_t b) const noexcept {
    for (;;) {
      a = first_of(a);
      b = first_of(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t itself = a;
      if (at(a).compare_exchange_strong(itself, b)) return;
    }
  }

 private:
  [[nodiscard]] AtomicRef<std::uint32_t> at(std::uint32_t body) const noexcept {
    return AtomicRef<std::uint32_t>(towards_[body]);
  }

  Column<std::uint32_t>& towards_;
};

/// The pairs to be grouped. Fixed bodies are not movable and join nothing.
struct MovablePairs {
  const SceneState& scene;
  const ContactFrame& frame;

  [[nodiscard]] std::size_t size() const noexcept { return frame.pairs(); }
  [[nodiscard]] bool is_movable(std::size_t pair, int side) const noexcept {
    return scene.body_state[frame.key[side][pair].id] != BodyState::fixed;
  }
  /// Returns the first movable body; at least one body of a contact is movable.
  [[nodiscard]] std::uint32_t movable(std::size_t pair) const noexcept {
    return frame.key[is_movable(pair, 0) ? 0 : 1][pair].id;
  }
  [[nodiscard]] bool are_valid() const noexcept {
    const auto is_valid = [&](const Key& key) { return scene.keys.is_valid(key); };
    return std::all_of(frame.key[0].begin(), frame.key[0].end(), is_valid) &&
           std::all_of(frame.key[1].begin(), frame.key[1].end(), is_valid);
  }
};

}  // namespace

void ContactGroups::clear() noexcept {
  group_.clear();
  first_.clear();
  order_.clear();
}

Footprint ContactGroups::footprint() const noexcept {
  Footprint footprint;
  footprint.results = bytes_of(group_, first_, order_);
  footprint.scratch = bytes_of(of_body_, colours_);
  return footprint;
}

bool ContactGroups::sort(std::size_t groups) noexcept {
  if (!first_.resize(groups + 1) || !order_.resize(group_.size())) return false;
  const Execution serial = Execution::serial();
  CountingSort by_group({group_.data(), group_.size()}, {first_.data(), first_.size()}, serial);
  by_group.count();
  (void)by_group.find_starts();
  by_group.place(order_.data());
  return true;
}

Status Scene::islands(const Contacts& contacts, ContactGroups& out) const {
  if (state_ == nullptr || contacts.state_ == nullptr) return Status::out_of_memory;
  const MovablePairs pairs{*state_, contacts.state_->frame};
  if (!pairs.are_valid()) return Status::invalid_key;
  const std::size_t bodies = state_->keys.slot_count();
  out.clear();
  if (!out.group_.resize(pairs.size()) || !out.of_body_.resize(bodies)) {
    out.clear();
    return Status::out_of_memory;
  }
  const BodySets sets(out.of_body_);
  for_each_range(state_->options.execution, pairs.size(), kPairsPerJoin,
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t i = first; i < end; ++i) {
                     if (!pairs.is_movable(i, 0) || !pairs.is_movable(i, 1)) continue;
                     sets.join(pairs.frame.key[0][i].id, pairs.frame.key[1][i].id);
                   }
                 });
  for_each_range(state_->options.execution, pairs.size(), kPairsPerJoin,
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t i = first; i < end; ++i) {
                     out.group_[i] = sets.first_of(pairs.movable(i));
                   }
                 });
  // Replaces root bodies with island numbers, in the order of the first pairs.
  std::fill(out.of_body_.begin(), out.of_body_.end(), kNoContact);
  std::uint32_t islands = 0;
  for (std::uint32_t& group : out.group_) {
    std::uint32_t& number = out.of_body_[group];
    if (number == kNoContact) number = islands++;
    group = number;
  }
  if (out.sort(islands)) return Status::ok;
  out.clear();
  return Status::out_of_memory;
}

Status Scene::colours(const Contacts& contacts, ContactGroups& out) const {
  if (state_ == nullptr || contacts.state_ == nullptr) return Status::out_of_memory;
  const MovablePairs pairs{*state_, contacts.state_->frame};
  if (!pairs.are_valid()) return Status::invalid_key;
  out.clear();
  if (!out.group_.resize(pairs.size()) || !out.colours_.resize(state_->keys.slot_count())) {
    out.clear();
    return Status::out_of_memory;
  }
  std::fill(out.colours_.begin(), out.colours_.end(), std::uint64_t{0});
  std::uint32_t groups = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::uint64_t* used[2] = {};
    std::uint64_t taken = 0;
    for (int side = 0; side < 2; ++side) {
      if (!pairs.is_movable(i, side)) continue;
      used[side] = &out.colours_[pairs.frame.key[side][i].id];
      taken |= *used[side];
    }
    // The bit of kRestColour is never set, so `colour` is kRestColour if all other bits are set.
    const auto colour = static_cast<std::uint32_t>(std::countr_one(taken));
    out.group_[i] = colour;
    groups = std::max(groups, colour + 1);
    if (colour == kRestColour) continue;
    for (std::uint64_t* const body : used) {
      if (body != nullptr) *body |= std::uint64_t{1} << colour;
    }
  }
  if (out.sort(groups)) return Status::ok;
  out.clear();
  return Status::out_of_memory;
}

}  // namespace winnow
