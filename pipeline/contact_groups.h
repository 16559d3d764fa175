#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// At most so many groups are made by Scene::colours, the last of them the rest.
inline constexpr std::uint32_t kContactColours = 64;
/// The group of pairs that found no colour: bodies of theirs have more contacts than there are
/// colours. They share bodies and are to be solved one after the other, after all others.
inline constexpr std::uint32_t kRestColour = kContactColours - 1;

/// Pairs of Contacts in groups, as columns of indices beside them: Scene::islands and
/// Scene::colours. The caller's, reused from frame to frame; void once the Contacts are filled
/// anew.
class WINNOW_API ContactGroups {
 public:
  /// Every allocation comes from `memory`, which must outlive the object; none before the first
  /// use.
  explicit ContactGroups(std::pmr::memory_resource* memory = default_memory()) noexcept
      : group_(memory), first_(memory), order_(memory), of_body_(memory), colours_(memory) {}

  /// Groups, none of them empty.
  [[nodiscard]] std::size_t size() const noexcept { return first_.empty() ? 0 : first_.size() - 1; }
  /// By pair of the contacts.
  [[nodiscard]] std::span<const std::uint32_t> group() const noexcept {
    return {group_.data(), group_.size()};
  }
  /// The pairs of a group, ascending.
  [[nodiscard]] std::span<const std::uint32_t> pairs(std::size_t group) const noexcept {
    return {order_.data() + first_[group], first_[group + 1] - first_[group]};
  }

  /// Forgets everything; memory is kept.
  void clear() noexcept;
  /// What can be read under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class Scene;
  [[nodiscard]] bool sort(std::size_t groups) noexcept;

  Column<std::uint32_t> group_;
  Column<std::uint32_t> first_;
  Column<std::uint32_t> order_;
  /// By id of a body: the one of its island that it was joined to; which colours it has.
  Column<std::uint32_t> of_body_;
  Column<std::uint64_t> colours_;
};

}  // namespace winnow
