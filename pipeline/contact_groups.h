#pragma once

#include <winnow/core/export.h>
#include <winnow/core/memory.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Largest number of groups made by Scene::colours; the last one is kRestColour.
inline constexpr std::uint32_t kContactColours = 64;
/// The group of pairs whose two bodies together already use all other colours. Its pairs may share
/// bodies: solve them one by one, after all other groups.
inline constexpr std::uint32_t kRestColour = kContactColours - 1;

/// Groups of the pairs of Contacts, as columns of indices; the result of Scene::islands and
/// Scene::colours. The caller keeps the object from frame to frame. It is invalid once the Contacts
/// are filled again.
class WINNOW_API ContactGroups {
 public:
  /// Creates an empty grouping. Every allocation comes from `memory`, which must outlive the
  /// object; there are none before the first use.
  explicit ContactGroups(std::pmr::memory_resource* memory = default_memory()) noexcept
      : group_(memory), first_(memory), order_(memory), of_body_(memory), colours_(memory) {}

  /// Returns the number of groups; none of them is empty.
  [[nodiscard]] std::size_t size() const noexcept { return first_.empty() ? 0 : first_.size() - 1; }
  /// Returns the group of each pair of the contacts.
  [[nodiscard]] std::span<const std::uint32_t> group() const noexcept { return group_; }
  /// Returns the pairs of a group, ascending.
  [[nodiscard]] std::span<const std::uint32_t> pairs(std::size_t group) const noexcept {
    return {order_.data() + first_[group], first_[group + 1] - first_[group]};
  }

  /// Removes all groups; memory is kept.
  void clear() noexcept;
  /// Returns the bytes of readable columns under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class Scene;
  [[nodiscard]] bool sort(std::size_t groups) noexcept;

  Column<std::uint32_t> group_;
  Column<std::uint32_t> first_;
  Column<std::uint32_t> order_;
  /// By body id: the parent body in its island (union-find), and the set of colours in use.
  Column<std::uint32_t> of_body_;
  Column<std::uint64_t> colours_;
};

}  // namespace winnow
