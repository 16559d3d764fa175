#include "partitions/structures/structure.h"

namespace winnow {

std::string_view StructureKind::name() const noexcept {
  return info_ == nullptr ? std::string_view() : info_->name;
}

void Structure::leave_all(const RowPlan& plan) const noexcept {
  for (std::size_t row = 0; row < plan.rows; ++row) {
    if (pool().ids()[row] != kNoObject) (void)plan.rest.push_back(static_cast<std::uint32_t>(row));
  }
}

}  // namespace winnow
