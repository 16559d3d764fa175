#include "pipeline/recording/shape_recording.h"

#include "pipeline/kinds/with_shape.h"
#include "pipeline/recording/composite_bytes.h"
#include "pipeline/recording/contact_digest.h"
#include "pipeline/shapes/hull_bytes.h"

#include <algorithm>
#include <type_traits>

namespace winnow {
namespace {

/// Number of a shape that was removed or replaced.
constexpr std::uint32_t kRemovedShape = ~0U;

std::uint64_t digest_of(const ShapeTables& tables, ShapeId id) noexcept {
  Digest digest;
  with_shape(tables, id, [&](const auto& shape) {
    if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, HullShape>) {
      add_to(digest, shape);
    } else {
      digest.add(std::as_bytes(std::span(&shape, 1)));
    }
  });
  return digest.value();
}

}  // namespace

ShapeRecording::ShapeRecording(RecorderState& recorder, std::uint32_t world,
                               const ShapePool& shapes, const CompositePool* composites) noexcept
    : recorder_(recorder),
      world_(world),
      shapes_(shapes),
      composites_(composites),
      composites_seen_(composites == nullptr ? 0 : composites->revision()),
      recorded_(recorder.block.memory()) {}

// False for shapes that a recording cannot contain: support functions, one-sided surfaces, solids.
bool ShapeRecording::can_record(ShapeId id) const noexcept {
  if (!id.is_composite()) return id.kind() != ShapeKind::support;
  return composites_ != nullptr && !composites_->is_one_sided(id) && !composites_->is_solid(id);
}

RecordedShape* ShapeRecording::find(ShapeId id) noexcept {
  RecordedShape* const at = std::lower_bound(
      recorded_.begin(), recorded_.end(), id.bits,
      [](const RecordedShape& shape, std::uint32_t bits) { return shape.id.bits < bits; });
  return at != recorded_.end() && at->id == id ? at : nullptr;
}

void ShapeRecording::describe(RecordedShape& shape) const noexcept {
  if (shape.id.is_composite()) {
    const CompositeDigests digests = digests_of(*composites_, shape.id);
    shape.digest = digests.all;
    shape.form = digests.form;
  } else {
    shape.digest = digest_of(shapes_.tables(), shape.id);
    shape.form = 0;
  }
}

// The digest shows whether another shape has the id now. For composite shapes, record_changes
// compares the digests.
std::uint32_t ShapeRecording::number_of(ShapeId id) noexcept {
  if (!can_record(id)) {
    recorder_.stop(Status::unsupported);
    return 0;
  }
  if (id.is_composite()) record_changes();
  RecordedShape* const at = find(id);
  if (at != nullptr && id.is_composite() && at->number != kRemovedShape) return at->number;
  RecordedShape shape{id, 0, 0, 0};
  describe(shape);
  if (at != nullptr && at->number != kRemovedShape && at->digest == shape.digest) return at->number;
  if (id.is_composite()) {
    for (const CompoundChild& child : composites_->children(id)) (void)number_of(child.shape);
  }
  shape.number = count_++;
  if (at != nullptr) {
    *find(id) = shape;
  } else {
    insert(shape);
  }
  id.is_composite() ? record_composite(shape) : record_shape(shape);
  return shape.number;
}

void ShapeRecording::insert(const RecordedShape& shape) noexcept {
  const Lock lock(recorder_.mutex);
  if (!recorded_.push_back(shape)) return recorder_.fail(Status::out_of_memory);
  const auto by_id = [](const RecordedShape& a, const RecordedShape& b) {
    return a.id.bits < b.id.bits;
  };
  std::rotate(std::upper_bound(recorded_.begin(), recorded_.end() - 1, shape, by_id),
              recorded_.end() - 1, recorded_.end());
}

void ShapeRecording::record_shape(const RecordedShape& shape) noexcept {
  CallWriter call(recorder_, RecordedCall::add_shape, world_);
  call.put(shape.id.kind());
  with_shape(shapes_.tables(), shape.id, [&](const auto& one) {
    if constexpr (std::is_same_v<std::decay_t<decltype(one)>, HullShape>) {
      put_hull(call, one);
    } else {
      call.put_bytes(&one, sizeof one);
    }
  });
  call.put(shape.digest);
}

void ShapeRecording::record_composite(const RecordedShape& shape) noexcept {
  CallWriter call(recorder_, RecordedCall::add_composite, world_);
  Column<std::byte> bytes(recorded_.memory());  // used under the recorder's lock
  const Status status = save_composite(*composites_, shape.id, bytes);
  if (status != Status::ok) return call.give_up(status);
  call.put(shape.id.composite_kind());
  call.put_array(std::span<const std::byte>(bytes.data(), bytes.size()));
  const auto scale = composites_->scale(shape.id);
  call.put_bytes(scale.data(), sizeof scale);
  const auto children = composites_->children(shape.id);
  call.put(std::uint64_t{children.size()});
  for (const CompoundChild& child : children) {
    const RecordedShape* const one = find(child.shape);
    call.put(one == nullptr ? 0U : one->number).put_bytes(&child.pose, sizeof child.pose);
  }
  call.put(shape.digest);
}

void ShapeRecording::record_changes() noexcept {
  if (composites_ == nullptr || composites_->revision() == composites_seen_) return;
  composites_seen_ = composites_->revision();
  bool has_recorded = false;
  for (RecordedShape& known : recorded_) {
    if (!known.id.is_composite()) continue;
    RecordedShape now = known;
    if (composites_->contains(known.id)) {
      if (!can_record(known.id)) recorder_.stop(Status::unsupported);
      describe(now);
    }
    if (!composites_->contains(known.id) || now.form != known.form) {
      known.number = kRemovedShape;
    } else if (now.digest != known.digest && known.number != kRemovedShape) {
      known = now;
      has_recorded = true;
      CallWriter(recorder_, RecordedCall::change_composite, world_)
          .put(known.number)
          .put_array(values_of(*composites_, known.id))
          .put(known.digest);
    }
  }
  if (!has_recorded) CallWriter(recorder_, RecordedCall::composites_changed, world_);
}

void ShapeRecording::put_names(CallWriter& call) const noexcept {
  const auto is_there = [](const RecordedShape& shape) { return shape.number != kRemovedShape; };
  const auto count = std::count_if(recorded_.begin(), recorded_.end(), is_there);
  call.put(static_cast<std::uint64_t>(count));
  for (const RecordedShape& shape : recorded_) {
    if (is_there(shape)) call.put(shape.id.bits).put(shape.number);
  }
}

}  // namespace winnow
