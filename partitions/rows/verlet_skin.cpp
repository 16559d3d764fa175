#include "partitions/rows/verlet_skin.h"

#include "core/memory/columns.h"
#include "partitions/rows/volume_source.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

using GivenBox = VerletSkin::DeferredBox;

static_assert(sizeof(GivenBox) == 6 * sizeof(float));

GivenBox as_given(const Aabb& box) noexcept {
  return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
}

BoxView view_of(const GivenBox* boxes, std::size_t count) noexcept {
  if (count == 0) return {};
  const float* const low = boxes->min;
  const float* const high = boxes->max;
  return {{low, low + 1, low + 2}, {high, high + 1, high + 2}, count, sizeof(GivenBox)};
}

}  // namespace

bool VerletSkin::begin(const Rows& rows, float skin) noexcept {
  const std::size_t slots = rows.keys().slot_count();
  max_departed_ = static_cast<std::uint32_t>(rows.size() / 32 + 16);
  if (!given_.resize(slots) || !stored_.resize(slots) ||
      !departed_.resize(max_departed_ + 2 * kBlockRows)) {
    drop();
    return false;
  }
  const RowView view = rows.view();
  for (std::size_t row = 0; row < rows.pool().rows(); ++row) {
    const ObjectId id = view.id[row];
    if (id != kNoObject) stored_[id] = given_[id] = as_given(stored_box(view.column, row));
  }
  skin_ = skin;
  active_.store(true, std::memory_order_release);
  return true;
}

Status VerletSkin::update(Rows& rows, const UpdateSubset& entries, const BoxView& boxes) {
  if (const Status status = rows.check(entries, boxes); status != Status::ok) return status;
  pending_ = true;
  if (!copy(entries, boxes)) {
    (void)write(rows);
    drop();
    return rows.update(entries, boxes);
  }
  for (const ObjectId id : departed_) {
    const Key key = rows.keys().key_of(id);
    // If a key is repeated, the row gets the last box, which may be within the skin again.
    (void)rows.update(UpdateSubset(std::span(&key, 1)), view_of(given_.data() + id, 1));
    stored_[id] = given_[id];
  }
  return Status::ok;
}

Status VerletSkin::update(Rows& rows, Key key, const Aabb& box) {
  if (!rows.keys().is_valid(key)) return Status::invalid_key;
  const BoxView view(std::span<const Aabb>(&box, 1));
  if (!BoxSource{view}.valid(0)) return Status::invalid_bounds;
  const GivenBox given = as_given(box);
  const bool departed =
      box_input_kernels().copy_near(given.min, stored_[key.id].min, given_[key.id].min, 1, skin_,
                                    departed_.data(), 0) != 0;
  pending_ = true;
  if (!departed) return Status::ok;
  stored_[key.id] = given;
  return rows.update(key, box);
}

// Collects in departed_ the ids whose boxes left the skin. False if there are more than
// max_departed_.
bool VerletSkin::copy(const UpdateSubset& entries, const BoxView& boxes) noexcept {
  const bool packed = BoxSource{boxes}.packed();
  departed_.clear();
  for (std::size_t begin = 0; begin < entries.count;) {
    // Consecutive ids have consecutive boxes in both arrays, so one kernel call handles the whole
    // run.
    const std::size_t i = entries[begin];
    const ObjectId first = entries.keys[i].id;
    std::size_t end = begin + 1;
    while (packed && end < entries.count && entries[end] - i == end - begin &&
           entries.key(end).id - first == end - begin) {
      ++end;
    }
    const GivenBox one = packed ? GivenBox{} : as_given(boxes[i]);
    const float* const from = packed ? boxes.min[0] + 6 * i : one.min;
    std::uint32_t* const departed = departed_.end();
    const std::uint32_t found = box_input_kernels().copy_near(
        from, stored_[first].min, given_[first].min, end - begin, skin_, departed,
        max_departed_ - static_cast<std::uint32_t>(departed_.size()));
    for (std::uint32_t k = 0; k < found; ++k) departed[k] += first;
    departed_.set_size(departed_.size() + found);
    if (departed_.size() > max_departed_) return false;
    begin = end;
  }
  return true;
}

bool VerletSkin::insert(std::span<const Key> keys, const BoxView& boxes) noexcept {
  std::size_t slots = stored_.size();
  for (const Key key : keys) slots = std::max<std::size_t>(slots, key.id + std::size_t{1});
  if (!given_.resize(slots) || !stored_.resize(slots)) return false;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    stored_[keys[i].id] = given_[keys[i].id] = as_given(boxes[i]);
  }
  return true;
}

bool VerletSkin::write(Rows& rows) noexcept {
  if (pending_) rows.write_by_id(view_of(given_.data(), given_.size()));
  return std::exchange(pending_, false);
}

void VerletSkin::release() noexcept {
  release_columns(given_, stored_, departed_);
}

void VerletSkin::drop() noexcept {
  given_.clear();
  stored_.clear();
  departed_.clear();
  pending_ = false;
  active_.store(false, std::memory_order_release);
}

Bytes VerletSkin::bytes() const noexcept {
  return bytes_of(given_, stored_, departed_);
}

}  // namespace winnow
