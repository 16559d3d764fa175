#include "partitions/structures/structure.h"

namespace winnow {

std::string_view StructureKind::name() const noexcept {
  return info_ == nullptr ? std::string_view() : info_->name;
}

void Structure::leave_all(const RowPlan& plan) const noexcept {
  const ObjectId* const ids = pool().ids();
  std::uint32_t* to = plan.rest.end();
  for (std::size_t row = 0; row < plan.rows; ++row) {
    *to = static_cast<std::uint32_t>(row);
    to += ids[row] != kNoObject ? 1 : 0;
  }
  plan.rest.set_size(static_cast<std::size_t>(to - plan.rest.data()));
}

}  // namespace winnow
