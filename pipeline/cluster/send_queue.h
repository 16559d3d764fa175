#pragma once

// Messages about bodies between ranks: SendQueue collects them, BodyMessages reads them,
// BodyChanges collects their effect on the receiver. Used by RankBodies (boxes) and RankScene
// (records).

#include <winnow/core/key.h>
#include <winnow/pipeline/cluster_transport.h>
#include "pipeline/cluster/name_table.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// Traverses two lists that are sorted by `to`: calls call(to, entries of the first list, entries
/// of the second list) for each receiver.
template <typename One, typename Other, typename Call>
void for_each_receiver(std::span<const One> ones, std::span<const Other> others, Call&& call) {
  const auto run_to = [](const auto& entries, std::size_t first, std::uint32_t to) {
    std::size_t end = first;
    while (end < entries.size() && entries[end].to == to) ++end;
    return entries.subspan(first, end - first);
  };
  std::size_t i = 0;
  std::size_t k = 0;
  while (i < ones.size() || k < others.size()) {
    const bool other_is_first =
        i == ones.size() || (k < others.size() && others[k].to < ones[i].to);
    const std::uint32_t to = other_is_first ? others[k].to : ones[i].to;
    const auto of_one = run_to(ones, i, to);
    const auto of_other = run_to(others, k, to);
    call(to, of_one, of_other);
    i += of_one.size();
    k += of_other.size();
  }
}

/// Messages from one rank to others: bodies that a receiver adds or updates, and bodies that it
/// removes. The columns of a message are, in this order: names and contents (boxes or records) of
/// bodies to add or update, whether each belongs to the receiver (1) or is a copy (0), and names of
/// bodies to remove.
template <typename Content>
class SendQueue {
 public:
  /// A body to be sent.
  struct Body {
    std::uint64_t name = 0;
    std::uint32_t owner = 0;  ///< the rank that it belongs to
    bool same = false;        ///< unchanged: ranks that keep a copy need no message
  };

  void clear() noexcept {
    held_.clear();
    gone_.clear();
  }
  /// Adds messages about one body to ranks other than `self`: ranks in `now` add or update it,
  /// ranks only in `before` remove it. Both lists are sorted.
  void add_messages(std::uint32_t self, const Body& body, const Content& content,
                    std::span<const std::uint32_t> before, std::span<const std::uint32_t> now);

  /// Adds one message per receiver. The messages refer to columns of this object.
  void pack(std::uint32_t from, std::vector<RankMessage>& messages);

 private:
  struct Held {
    std::uint32_t to;
    bool belongs;
    std::uint64_t name;
    Content content;
  };
  struct Gone {
    std::uint32_t to;
    std::uint64_t name;
  };

  std::vector<Held> held_;
  std::vector<Gone> gone_;
  std::vector<std::uint64_t> names_;
  std::vector<Content> contents_;
  std::vector<std::uint8_t> belongs_;
  std::vector<std::uint64_t> gone_names_;
};

/// Returns a column of a message as elements.
template <typename T>
[[nodiscard]] std::span<const T> column_of(const RankMessage& message,
                                           std::size_t column) noexcept {
  const std::span<const std::byte> bytes = message.columns[column];
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

/// A message of a SendQueue, as its receiver reads it.
template <typename Content>
struct BodyMessages {
  explicit BodyMessages(const RankMessage& message) noexcept
      : names(column_of<std::uint64_t>(message, 0)),
        contents(column_of<Content>(message, 1)),
        belongs(column_of<std::uint8_t>(message, 2)),
        gone(column_of<std::uint64_t>(message, 3)) {}

  std::span<const std::uint64_t> names;
  std::span<const Content> contents;
  std::span<const std::uint8_t> belongs;
  std::span<const std::uint64_t> gone;
};

/// All changes of a rank's bodies by one exchange: bodies that left the rank, and the contents of
/// received messages. They are applied at once.
template <typename Place, typename Content>
struct BodyChanges {
  std::vector<Key> dropped;
  /// Bodies that the rank already has, and their new boxes or poses.
  std::vector<Key> keys;
  std::vector<Place> places;
  /// Bodies to add: names, contents, and whether they belong to this rank.
  std::vector<BodyName> names;
  std::vector<Content> fresh;
  std::vector<std::uint8_t> belongs;

  void clear() noexcept {
    dropped.clear();
    keys.clear();
    places.clear();
    names.clear();
    fresh.clear();
    belongs.clear();
  }
  void add_fresh(const BodyMessages<Content>& incoming, std::size_t i) {
    names.push_back(incoming.names[i]);
    fresh.push_back(incoming.contents[i]);
    belongs.push_back(incoming.belongs[i]);
  }
};

/// For each name that the messages list as removed, calls drop(id) and erases it from the table.
template <typename Content, typename Drop>
void take_gone(std::span<const RankMessage> messages, NameTable& table, Drop&& drop) {
  for (const RankMessage& message : messages) {
    for (const BodyName name : BodyMessages<Content>(message).gone) {
      const std::uint32_t id = table.find(name);
      if (id == NameTable::kNone) continue;
      drop(id);
      table.erase(name);
    }
  }
}

template <typename Content>
void SendQueue<Content>::add_messages(std::uint32_t self, const Body& body, const Content& content,
                                      std::span<const std::uint32_t> before,
                                      std::span<const std::uint32_t> now) {
  const auto add_gone = [&](std::uint32_t to) {
    if (to != self) gone_.push_back({to, body.name});
  };
  std::size_t b = 0;
  for (const std::uint32_t to : now) {
    while (b < before.size() && before[b] < to) add_gone(before[b++]);
    const bool held = b < before.size() && before[b] == to;
    if (held) ++b;
    if (to != self && !(held && body.same && to != body.owner)) {
      held_.push_back({to, to == body.owner, body.name, content});
    }
  }
  while (b < before.size()) add_gone(before[b++]);
}

template <typename Content>
void SendQueue<Content>::pack(std::uint32_t from, std::vector<RankMessage>& messages) {
  const auto by_receiver = [](const auto& a, const auto& b) { return a.to < b.to; };
  // With two ranks, all messages have the same receiver.
  const auto sort = [&](auto& entries) {
    if (std::ranges::is_sorted(entries, by_receiver)) return;
    std::stable_sort(entries.begin(), entries.end(), by_receiver);
  };
  sort(held_);
  sort(gone_);
  names_.clear();
  contents_.clear();
  belongs_.clear();
  gone_names_.clear();
  for (const Held& held : held_) {
    names_.push_back(held.name);
    contents_.push_back(held.content);
    belongs_.push_back(held.belongs ? 1 : 0);
  }
  for (const Gone& gone : gone_) gone_names_.push_back(gone.name);
  const std::span<const Held> all_held(held_);
  const std::span<const Gone> all_gone(gone_);
  for_each_receiver(all_held, all_gone, [&](std::uint32_t to, auto held, auto gone) {
    const auto h = static_cast<std::size_t>(held.data() - held_.data());
    const auto g = static_cast<std::size_t>(gone.data() - gone_.data());
    messages.push_back({from,
                        to,
                        {std::as_bytes(std::span(names_).subspan(h, held.size())),
                         std::as_bytes(std::span(contents_).subspan(h, held.size())),
                         std::as_bytes(std::span(belongs_).subspan(h, held.size())),
                         std::as_bytes(std::span(gone_names_).subspan(g, gone.size()))}});
  });
}

}  // namespace winnow
