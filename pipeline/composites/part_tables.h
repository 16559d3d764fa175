#pragma once

#include "pipeline/composites/parts.h"

#include <cstddef>

namespace winnow {

/// Shape tables in which two parts can be looked up, whether or not they are in the pool.
class PartTables {
 public:
  explicit PartTables(const ShapePool& pool) noexcept;
  PartTables(const PartTables&) = delete;
  PartTables& operator=(const PartTables&) = delete;

  /// Stores a part in slot 0 or 1 and returns its id in `tables`.
  [[nodiscard]] ShapeId put(std::size_t slot, const SubShape& part) noexcept;
  [[nodiscard]] const ShapeTables& tables() const noexcept { return tables_; }

 private:
  const ShapeTables& pool_;
  ShapeTables tables_;
  TriangleShape triangles_[2];
  SphereShape balls_[2];
  /// Uninitialised until a hull is put, because most pairs have none.
  union {
    HullShape hulls_[2];
  };
};

}  // namespace winnow
