#include "partitions/structures/structure.h"

#include <algorithm>
#include <numeric>

namespace winnow {

std::string_view StructureKind::name() const noexcept {
  return info_ == nullptr ? std::string_view() : info_->name;
}

void Structure::append_all_to_rest(const RowPlan& plan) const noexcept {
  if (plan.objects == plan.rows) {
    plan.rest.set_size(plan.rest.size() + plan.rows);
    std::iota(plan.rest.end() - plan.rows, plan.rest.end(), 0U);
    return;
  }
  const ObjectId* const ids = pool().ids();
  std::uint32_t* to = plan.rest.end();
  for (std::size_t row = 0; row < plan.rows; ++row) {
    *to = static_cast<std::uint32_t>(row);
    to += ids[row] != kNoObject ? 1 : 0;
  }
  plan.rest.set_size(static_cast<std::size_t>(to - plan.rest.data()));
}

std::size_t Structure::current_row(const RowPlan& plan, std::size_t row) const noexcept {
  if (pool().ids()[row] != kNoObject) return row;
  const auto move = std::ranges::lower_bound(plan.moves, row, {}, &RowMove::row);
  const bool found = move != plan.moves.end() && move->row == row;
  return found && rows_.keys().is_live(move->id) ? rows_.keys().row_of(move->id) : row;
}

}  // namespace winnow
