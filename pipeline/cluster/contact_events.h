#pragma once

#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_transport.h>

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// A pair that touches, as ranks know it: sorts as contacts do.
struct TouchingPair {
  std::uint64_t code = 0;  ///< of the kinds of its shapes
  BodyName a = 0;
  BodyName b = 0;

  friend constexpr auto operator<=>(const TouchingPair&, const TouchingPair&) noexcept = default;
};

/// Which of a rank's pairs began, and which ended. The rank that reports a pair changes as bodies
/// move, so that what began here may have ended there. Where a rank cannot know, it tells both to
/// the rank that the pair's hash says, which finds what is in both lists: two exchanges, of as much
/// as changed near borders.
class ContactEvents {
 public:
  ContactEvents(std::uint32_t rank, std::uint32_t ranks) : rank_(rank), ranks_(ranks) {}

  /// What is known of a pair that touches now.
  enum class Knowledge : std::uint8_t {
    is_new,  ///< one of its bodies is: it cannot have touched before
    local,   ///< it was this rank's before too, if it was at all
    none,
  };

  /// Takes the pairs that touch now, sorted, and what is known of each. `was_local(pair)`: a pair
  /// that touched before would still be this rank's.
  template <typename WasLocal>
  void compare(std::vector<TouchingPair>& now, std::span<const Knowledge> knowledge,
               WasLocal&& was_local);
  /// 1: tells the keepers of pairs what may have begun and ended.
  void ask(std::vector<Parcel>& parcels);
  /// 2: tells of those that did both.
  void answer(std::span<const Parcel> asked, std::vector<Parcel>& parcels);
  /// 3: takes back what went on.
  void conclude(std::span<const Parcel> answers);

  /// One of each pair that touches now: not 0 if it did before.
  [[nodiscard]] std::span<const std::uint8_t> persisted() const noexcept { return persisted_; }
  /// Sorted.
  [[nodiscard]] std::span<const TouchingPair> ended() const noexcept { return ended_; }

  /// Pairs that touch, sorted: what is to be kept of this.
  [[nodiscard]] std::span<const TouchingPair> touching() const noexcept { return touching_; }
  /// Adds pairs that touched on another rank.
  void remember(std::span<const TouchingPair> pairs);

 private:
  /// A pair on its way to its keeper, or back to a rank.
  struct Posted {
    std::uint32_t to;
    TouchingPair pair;
    friend constexpr auto operator<=>(const Posted&, const Posted&) noexcept = default;
  };

  [[nodiscard]] std::uint32_t keeper_of(const TouchingPair& pair) const noexcept;
  /// What is sent, which lies here until the next time.
  struct Columns {
    std::vector<TouchingPair> begun;
    std::vector<TouchingPair> ended;
  };
  void post(std::vector<Posted>& begun, std::vector<Posted>& ended, Columns& columns,
            std::vector<Parcel>& parcels) const;

  std::uint32_t rank_;
  std::uint32_t ranks_;
  std::vector<TouchingPair> touching_;
  std::vector<std::uint8_t> persisted_;
  std::vector<TouchingPair> ended_;
  std::vector<Posted> begun_in_doubt_;
  std::vector<Posted> ended_in_doubt_;
  Columns asked_;
  Columns answered_;
};

template <typename WasLocal>
void ContactEvents::compare(std::vector<TouchingPair>& now, std::span<const Knowledge> knowledge,
                            WasLocal&& was_local) {
  persisted_.assign(now.size(), 0);
  ended_.clear();
  begun_in_doubt_.clear();
  ended_in_doubt_.clear();
  const auto end_pair = [&](const TouchingPair& pair) {
    ended_.push_back(pair);
    if (!was_local(pair)) ended_in_doubt_.push_back({keeper_of(pair), pair});
  };
  auto before = touching_.cbegin();
  for (std::size_t i = 0; i < now.size(); ++i) {
    while (before != touching_.cend() && *before < now[i]) end_pair(*before++);
    const bool touched = before != touching_.cend() && *before == now[i];
    if (knowledge[i] == Knowledge::is_new) continue;  // one that touched was of others of that name
    if (touched) {
      persisted_[i] = 1;
      ++before;
    } else if (knowledge[i] == Knowledge::none) {
      begun_in_doubt_.push_back({keeper_of(now[i]), now[i]});
    }
  }
  while (before != touching_.cend()) end_pair(*before++);
  touching_.swap(now);
}

}  // namespace winnow
