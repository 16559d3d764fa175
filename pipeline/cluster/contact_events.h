#pragma once

#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_transport.h>

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// A touching pair, by names. Sorts in the order of contacts.
struct TouchingPair {
  std::uint64_t code = 0;  ///< code of the two kinds of shapes
  BodyName a = 0;
  BodyName b = 0;

  friend constexpr auto operator<=>(const TouchingPair&, const TouchingPair&) noexcept = default;
};

/// Determines which pairs of a rank have begun and ended. The rank that reports a pair may change
/// as bodies move, so that a pair that began on one rank may have ended on another. If a rank
/// cannot decide this, it sends the pair to the rank that the pair's hash selects (its keeper),
/// which finds the pairs that are in both lists. Takes two exchanges; the size of the messages is
/// proportional to the changes near borders.
class ContactEvents {
 public:
  ContactEvents(std::uint32_t rank, std::uint32_t ranks) : rank_(rank), ranks_(ranks) {}

  /// Information that a rank has about a pair that touches now.
  enum class Knowledge : std::uint8_t {
    is_new,  ///< one of its bodies is new: it did not touch before
    local,   ///< if it touched before, this rank reported it
    none,
  };

  /// Compares the pairs that touch now, sorted, with the pairs of the last call. `knowledge` has
  /// one entry per pair. `was_local(pair)` returns true if this rank would still report a previous
  /// pair.
  template <typename WasLocal>
  void compare(std::vector<TouchingPair>& now, std::span<const Knowledge> knowledge,
               WasLocal&& was_local);
  /// Step 1: sends the pairs that may have begun or ended to their keepers.
  void ask(std::vector<RankMessage>& parcels);
  /// Step 2, as keeper: returns the pairs that are in both lists.
  void answer(std::span<const RankMessage> asked, std::vector<RankMessage>& parcels);
  /// Step 3: marks the returned pairs as persisting.
  void conclude(std::span<const RankMessage> answers);

  /// For each pair that touches now: not 0 if it touched before.
  [[nodiscard]] std::span<const std::uint8_t> persisted() const noexcept { return persisted_; }
  /// The pairs that ended, sorted.
  [[nodiscard]] std::span<const TouchingPair> ended() const noexcept { return ended_; }

  /// All touching pairs, sorted; checkpoints save them.
  [[nodiscard]] std::span<const TouchingPair> touching() const noexcept { return touching_; }
  /// Adds pairs that touched on another rank.
  void remember(std::span<const TouchingPair> pairs);

 private:
  /// A pair to be sent to its keeper, or back to a rank.
  struct AddressedPair {
    std::uint32_t to;
    TouchingPair pair;
    friend constexpr auto operator<=>(const AddressedPair&,
                                      const AddressedPair&) noexcept = default;
  };

  [[nodiscard]] std::uint32_t keeper_of(const TouchingPair& pair) const noexcept;
  /// Data of the sent messages; must stay in place until the next step.
  struct Columns {
    std::vector<TouchingPair> begun;
    std::vector<TouchingPair> ended;
  };
  void post(std::vector<AddressedPair>& begun, std::vector<AddressedPair>& ended, Columns& columns,
            std::vector<RankMessage>& parcels) const;

  std::uint32_t rank_;
  std::uint32_t ranks_;
  std::vector<TouchingPair> touching_;
  std::vector<std::uint8_t> persisted_;
  std::vector<TouchingPair> ended_;
  std::vector<AddressedPair> begun_uncertain_;
  std::vector<AddressedPair> ended_uncertain_;
  Columns asked_;
  Columns answered_;
};

template <typename WasLocal>
void ContactEvents::compare(std::vector<TouchingPair>& now, std::span<const Knowledge> knowledge,
                            WasLocal&& was_local) {
  persisted_.assign(now.size(), 0);
  ended_.clear();
  begun_uncertain_.clear();
  ended_uncertain_.clear();
  const auto end_pair = [&](const TouchingPair& pair) {
    ended_.push_back(pair);
    if (!was_local(pair)) ended_uncertain_.push_back({keeper_of(pair), pair});
  };
  auto before = touching_.cbegin();
  for (std::size_t i = 0; i < now.size(); ++i) {
    while (before != touching_.cend() && *before < now[i]) end_pair(*before++);
    const bool touched = before != touching_.cend() && *before == now[i];
    if (knowledge[i] == Knowledge::is_new) continue;  // equal previous pairs had other bodies
    if (touched) {
      persisted_[i] = 1;
      ++before;
    } else if (knowledge[i] == Knowledge::none) {
      begun_uncertain_.push_back({keeper_of(now[i]), now[i]});
    }
  }
  while (before != touching_.cend()) end_pair(*before++);
  touching_.swap(now);
}

}  // namespace winnow
