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

/// Determines which pairs of a rank have begun and ended. If the bodies of a touching pair move,
/// another rank may report it: the pair then seems to begin on the new rank and to end on the old
/// one. If a rank cannot exclude this, it sends the pair to the rank that the pair's hash selects
/// (its keeper). Pairs that a keeper receives in both lists persist. Takes two exchanges; the size
/// of the messages is proportional to the number of pairs that changed near borders.
class ContactEvents {
 public:
  ContactEvents(std::uint32_t rank, std::uint32_t ranks) : rank_(rank), ranks_(ranks) {}

  /// Information that a rank has about a pair that touches now.
  enum class Knowledge : std::uint8_t {
    is_new,  ///< one of its bodies is new, so the pair did not touch before
    local,   ///< if the pair touched before, this rank reported it
    none,
  };

  /// Compares the pairs that touch now, sorted, with the pairs of the last call. `knowledge` has
  /// one entry per pair. `was_local(pair)` returns true if this rank would report a previous pair
  /// if it still touched.
  template <typename WasLocal>
  void compare(std::vector<TouchingPair>& now, std::span<const Knowledge> knowledge,
               WasLocal&& was_local);
  /// Step 1: sends to their keepers the pairs that seem to have begun or ended, but may persist.
  void request(std::vector<RankMessage>& messages);
  /// Step 2, as keeper: returns the pairs that are in both lists to their senders.
  void answer(std::span<const RankMessage> requests, std::vector<RankMessage>& messages);
  /// Step 3: the returned pairs persist.
  void conclude(std::span<const RankMessage> answers);

  /// For each pair that touches now: not 0 if it touched before.
  [[nodiscard]] std::span<const std::uint8_t> persisted() const noexcept { return persisted_; }
  /// The pairs that ended, sorted.
  [[nodiscard]] std::span<const TouchingPair> ended() const noexcept { return ended_; }

  /// All touching pairs, sorted; checkpoints save them.
  [[nodiscard]] std::span<const TouchingPair> touching() const noexcept { return touching_; }
  /// Adds pairs that touched on another rank.
  void add_touching(std::span<const TouchingPair> pairs);

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
            std::vector<RankMessage>& messages) const;

  std::uint32_t rank_;
  std::uint32_t ranks_;
  std::vector<TouchingPair> touching_;
  std::vector<std::uint8_t> persisted_;
  std::vector<TouchingPair> ended_;
  std::vector<AddressedPair> begun_uncertain_;
  std::vector<AddressedPair> ended_uncertain_;
  Columns requests_;
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
