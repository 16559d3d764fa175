#pragma once

#include <winnow/core/memory.h>
#include <winnow/partitions/structures.h>
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"

#include <memory_resource>
#include <span>

namespace winnow {

/// A structure and its kind; `structure` may be null.
struct OwnedStructure {
  StructureKind kind{};
  Structure* structure = nullptr;
};

/// Makes and destroys structures, and keeps spare ones with reserved memory for later use.
class StructureStore {
 public:
  /// `regular_tree` as in StructureInput.
  StructureStore(std::pmr::memory_resource* memory, const Rows& rows,
                 const BlockTree& regular_tree) noexcept
      : memory_(memory), rows_(rows), regular_tree_(regular_tree), spares_(memory) {}
  ~StructureStore() { destroy_spares(); }
  StructureStore(const StructureStore&) = delete;
  StructureStore& operator=(const StructureStore&) = delete;

  /// Returns a spare structure or a new one; null if an allocation fails.
  [[nodiscard]] Structure* make(StructureKind kind) noexcept;
  void destroy(const OwnedStructure& one) noexcept;
  /// Keeps a structure, which may be null, as a spare if `spare` is true and memory for its entry
  /// is granted; destroys it otherwise.
  void stash(const OwnedStructure& one, bool spare) noexcept;
  /// Makes a spare of each kind except `used`. Returns false if an allocation fails.
  [[nodiscard]] bool make_spares(std::span<const StructureKind> kinds, StructureKind used) noexcept;
  void destroy_spares() noexcept;

  /// The entries of spare structures; some are null.
  [[nodiscard]] std::span<const OwnedStructure> spares() const noexcept {
    return {spares_.data(), spares_.size()};
  }
  [[nodiscard]] Bytes bytes() const noexcept { return spares_.bytes(); }

 private:
  /// Keeps a structure as a spare. Returns false if an allocation fails.
  [[nodiscard]] bool keep(const OwnedStructure& one) noexcept;

  std::pmr::memory_resource* memory_;
  const Rows& rows_;
  const BlockTree& regular_tree_;
  Column<OwnedStructure> spares_;
};

}  // namespace winnow
