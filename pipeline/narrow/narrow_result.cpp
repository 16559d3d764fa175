#include "pipeline/kernels/kernels.h"
#include "pipeline/narrow/narrow_columns.h"
#include "pipeline/narrow/tight_growth.h"

namespace winnow {
ContactColumns::ContactColumns(std::pmr::memory_resource* memory) noexcept
    : position{Column<float>(memory), Column<float>(memory), Column<float>(memory)},
      depth(memory),
      feature(memory) {}

bool ContactColumns::grow(std::size_t count, Pages pages) noexcept {
  const std::size_t room = count + kContactSlack;
  const auto grow_one = [&](auto& column) {
    if (!column.grow(room)) return false;
    if (pages == Pages::prefaulted) column.touch();
    return true;
  };
  return grow_one(position[0]) && grow_one(position[1]) && grow_one(position[2]) &&
         grow_one(depth) && grow_one(feature);
}

void ContactColumns::set_size(std::size_t count) noexcept {
  for (Column<float>& column : position) column.set_size(count);
  depth.set_size(count);
  feature.set_size(count);
}

Bytes ContactColumns::bytes() const noexcept {
  Bytes bytes = depth.bytes();
  for (const Column<float>& column : position) bytes += column.bytes();
  bytes += feature.bytes();
  return bytes;
}

NarrowResult::NarrowResult(std::pmr::memory_resource* memory) noexcept
    : order_(memory),
      runs_(memory),
      overlap_(memory),
      distance_(memory),
      error_bound_(memory),
      normal_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      point_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      contact_first_(memory),
      contact_count_(memory),
      contacts_(memory) {}

bool NarrowColumns::resize(NarrowResult& result, std::size_t count, ContactLevel level) noexcept {
  result.contacts_.set_size(0);
  // The size is 0 after a call that failed.
  if (count != 0 && count == result.size() && level == result.level_) return true;
  const bool distances = level != ContactLevel::boolean;
  const auto size_of = [count](bool has) { return has ? count : 0; };
  bool ok = resize_tightly(result.overlap_, size_of(!distances)) &&
            resize_tightly(result.distance_, size_of(distances)) &&
            resize_tightly(result.error_bound_, size_of(distances));
  for (Column<double>& column : result.normal_)
    ok = ok && resize_tightly(column, size_of(distances));
  for (Column<double>& column : result.point_) {
    ok = ok && resize_tightly(column, size_of(level == ContactLevel::distance));
  }
  const bool manifolds = level == ContactLevel::manifold;
  ok = ok && resize_tightly(result.contact_first_, size_of(manifolds)) &&
       resize_tightly(result.contact_count_, size_of(manifolds));
  result.level_ = level;
  return ok;
}

void NarrowColumns::clear(NarrowResult& result) noexcept {
  result.order_.clear();
  result.runs_.clear();
  static_cast<void>(resize(result, 0, ContactLevel::boolean));
}

NarrowColumns NarrowColumns::of(NarrowResult& result) noexcept {
  const auto all = [](auto& column) { return std::span(column.data(), column.size()); };
  return {all(result.overlap_),
          all(result.distance_),
          all(result.error_bound_),
          {all(result.normal_[0]), all(result.normal_[1]), all(result.normal_[2])},
          {all(result.point_[0]), all(result.point_[1]), all(result.point_[2])},
          all(result.contact_first_),
          all(result.contact_count_),
          result.contacts_};
}

Footprint NarrowResult::footprint() const noexcept {
  Footprint footprint;
  Bytes& bytes = footprint.results;
  bytes += order_.bytes();
  bytes += runs_.bytes();
  bytes += overlap_.bytes();
  bytes += distance_.bytes();
  bytes += error_bound_.bytes();
  for (const Column<double>& column : normal_) bytes += column.bytes();
  for (const Column<double>& column : point_) bytes += column.bytes();
  bytes += contact_first_.bytes();
  bytes += contact_count_.bytes();
  bytes += contacts_.bytes();
  return footprint;
}

}  // namespace winnow
