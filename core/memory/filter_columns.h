#pragma once

#include <cstdint>

namespace winnow {

/// Columns of filters; all null if every object has the default filter. A plain struct of pointers,
/// because kernel sources may include only headers of plain structs.
struct FilterColumns {
  const std::uint32_t* layers = nullptr;
  const std::uint32_t* mask = nullptr;
  const std::uint32_t* environment = nullptr;
};

}  // namespace winnow
