// Conversion of the caller's columns to views of the engine; see convert.h.

#include "core/numbers/rounding.h"
#include "pipeline/c/binding/convert.h"

#include <winnow/core/volumes.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace winnow::c {
namespace {

template <std::size_t kColumns>
[[nodiscard]] bool are_columns(const void* const (&columns)[kColumns], std::size_t count) noexcept {
  return count == 0 || std::all_of(std::begin(columns), std::end(columns),
                                   [](const void* column) { return column != nullptr; });
}

[[nodiscard]] bool is_number(winnow_number number) noexcept {
  return number == WINNOW_FLOAT || number == WINNOW_DOUBLE;
}

[[nodiscard]] std::size_t stride_of(std::size_t given, winnow_number number) noexcept {
  if (given != 0) return given;
  return number == WINNOW_FLOAT ? sizeof(float) : sizeof(double);
}

template <typename Number, std::size_t kColumns>
[[nodiscard]] std::array<const Number*, kColumns> columns_of(
    const void* const (&given)[kColumns]) noexcept {
  std::array<const Number*, kColumns> columns{};
  for (std::size_t k = 0; k < kColumns; ++k) columns[k] = static_cast<const Number*>(given[k]);
  return columns;
}

[[nodiscard]] double number_at(const void* column, std::size_t i, std::size_t stride,
                               winnow_number number) noexcept {
  const std::byte* at = static_cast<const std::byte*>(column) + i * stride;
  return number == WINNOW_DOUBLE ? *reinterpret_cast<const double*>(at)
                                 : to_double(*reinterpret_cast<const float*>(at));
}

/// Calls `read(i)` for each of the selected entries below `count`. Skips indices that are out of
/// range: the partition refuses them later.
template <typename Read>
void for_entries(const IndexSubset* entries, std::size_t count, Read&& read) noexcept {
  if (entries == nullptr) {
    for (std::size_t i = 0; i < count; ++i) read(i);
  } else if (!entries->is_mask) {
    for (const std::uint32_t i : entries->indices) {
      if (i < count) read(i);
    }
  } else {
    const std::size_t end = std::min(count, entries->words.size() * 64);
    for (std::size_t i = 0; i < end; ++i) {
      if ((entries->words[i / 64] >> (i % 64) & 1U) != 0) read(i);
    }
  }
}

/// True if the poses are contiguous in the layout of the C++ struct.
[[nodiscard]] bool are_packed(const winnow_pose_view& given) noexcept {
  if (given.position_number != WINNOW_DOUBLE || given.orientation_number != WINNOW_DOUBLE ||
      given.position_stride != sizeof(Pose) || given.orientation_stride != sizeof(Pose)) {
    return false;
  }
  const auto* first = static_cast<const double*>(given.position[0]);
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (given.position[axis] != first + axis) return false;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    if (given.orientation[k] != first + 3 + k) return false;
  }
  return true;
}

[[nodiscard]] bool turn(const winnow_pose_view& given) noexcept {
  return std::any_of(std::begin(given.orientation), std::end(given.orientation),
                     [](const void* column) { return column != nullptr; });
}

[[nodiscard]] bool is_good(const winnow_pose_view& given) noexcept {
  return is_number(given.position_number) && is_number(given.orientation_number) &&
         are_columns(given.position, given.count) &&
         (!turn(given) || are_columns(given.orientation, given.count));
}

[[nodiscard]] Pose pose_at(const winnow_pose_view& given, std::size_t i) noexcept {
  Pose pose;
  const std::size_t stride = stride_of(given.position_stride, given.position_number);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pose.position[axis] = number_at(given.position[axis], i, stride, given.position_number);
  }
  if (!turn(given)) return pose;
  const std::size_t turn_stride = stride_of(given.orientation_stride, given.orientation_number);
  for (std::size_t k = 0; k < 4; ++k) {
    pose.orientation[k] = number_at(given.orientation[k], i, turn_stride, given.orientation_number);
  }
  return pose;
}

[[nodiscard]] Status pack_poses(const winnow_pose_view& given, Column<Pose>& room,
                                std::span<const Pose>& poses) noexcept {
  if (!room.resize(given.count)) return Status::out_of_memory;
  for (std::size_t i = 0; i < given.count; ++i) room[i] = pose_at(given, i);
  poses = {room.data(), room.size()};
  return Status::ok;
}

}  // namespace

Status read_view(const winnow_box_view& given, Column<float>& room, BoxView& boxes,
                 const IndexSubset* entries) noexcept {
  if (!is_number(given.number) || !are_columns(given.min, given.count) ||
      !are_columns(given.max, given.count)) {
    return Status::invalid_argument;
  }
  const std::size_t stride = stride_of(given.stride, given.number);
  const std::size_t count = given.count;
  if (given.number == WINNOW_FLOAT) {
    boxes = BoxView(columns_of<float>(given.min), columns_of<float>(given.max), count, stride);
    return Status::ok;
  }
  if (count > Column<float>::kMaxSize / 6 || !room.resize(6 * count)) return Status::out_of_memory;
  float* const to = room.data();
  for_entries(entries, count, [&](std::size_t i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      to[6 * i + axis] = round_down(number_at(given.min[axis], i, stride, WINNOW_DOUBLE));
      to[6 * i + 3 + axis] = round_up(number_at(given.max[axis], i, stride, WINNOW_DOUBLE));
    }
  });
  boxes = count == 0
              ? BoxView()
              : BoxView({to, to + 1, to + 2}, {to + 3, to + 4, to + 5}, count, 6 * sizeof(float));
  return Status::ok;
}

Status read_view(const winnow_pose_view& given, Column<Pose>& room, PoseView& poses) noexcept {
  if (!is_good(given)) return Status::invalid_argument;
  if (given.position_number == WINNOW_FLOAT) {
    std::span<const Pose> packed;
    const Status status = pack_poses(given, room, packed);
    if (status != Status::ok || packed.empty() || turn(given)) {
      poses = PoseView(packed);
    } else {
      const double* const first = packed.data()->position.data();
      poses = PoseView({first, first + 1, first + 2}, packed.size(), sizeof(Pose));
    }
    return status;
  }
  const std::array position = columns_of<double>(given.position);
  const std::size_t stride = stride_of(given.position_stride, WINNOW_DOUBLE);
  const std::size_t turn_stride = stride_of(given.orientation_stride, given.orientation_number);
  if (given.orientation_number == WINNOW_FLOAT) {
    poses =
        PoseView(position, columns_of<float>(given.orientation), given.count, stride, turn_stride);
  } else {
    poses =
        PoseView(position, columns_of<double>(given.orientation), given.count, stride, turn_stride);
  }
  return Status::ok;
}

Status read_view(const winnow_bodies& given, Column<Pose>& room, Bodies& bodies) noexcept {
  if (!is_array(given.shapes, given.count) || !is_good(given.poses)) {
    return Status::invalid_argument;
  }
  bodies.shapes = shape_ids(given.shapes, given.count);
  if (!are_packed(given.poses)) return pack_poses(given.poses, room, bodies.poses);
  bodies.poses = {static_cast<const Pose*>(given.poses.position[0]), given.poses.count};
  return Status::ok;
}

Status read_view(const winnow_point_view& given, PointView& points) noexcept {
  if (!is_number(given.number) || !are_columns(given.axis, given.count)) {
    return Status::invalid_argument;
  }
  const std::size_t stride = stride_of(given.stride, given.number);
  points = given.number == WINNOW_FLOAT
               ? PointView(columns_of<float>(given.axis), given.count, stride)
               : PointView(columns_of<double>(given.axis), given.count, stride);
  return Status::ok;
}

Status read_view(const winnow_index_view& given, IndexView& triangles) noexcept {
  if (!is_array(static_cast<const std::byte*>(given.corners), given.count)) {
    return Status::invalid_argument;
  }
  const auto read_as = [&]<typename Index>(Index /*one*/) {
    triangles = IndexView(static_cast<const Index*>(given.corners), given.count,
                          given.stride != 0 ? given.stride : 3 * sizeof(Index));
    return Status::ok;
  };
  if (given.index == WINNOW_UINT32) return read_as(std::uint32_t{});
  return given.index == WINNOW_UINT16 ? read_as(std::uint16_t{}) : Status::invalid_argument;
}

Status read_view(const winnow_shape_ray_batch& given, Column<ShapeRay>& room,
                 ShapeRayBatch& rays) noexcept {
  if (!is_number(given.number) || !are_columns(given.origin, given.count) ||
      !are_columns(given.direction, given.count)) {
    return Status::invalid_argument;
  }
  const std::size_t stride = stride_of(given.stride, given.number);
  if (given.number == WINNOW_DOUBLE) {
    rays = ShapeRayBatch(columns_of<double>(given.origin), columns_of<double>(given.direction),
                         given.count, static_cast<const double*>(given.min_t),
                         static_cast<const double*>(given.max_t), stride);
    return Status::ok;
  }
  if (!room.resize(given.count)) return Status::out_of_memory;
  for (std::size_t i = 0; i < given.count; ++i) {
    room[i] = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      room[i].origin[axis] = number_at(given.origin[axis], i, stride, WINNOW_FLOAT);
      room[i].direction[axis] = number_at(given.direction[axis], i, stride, WINNOW_FLOAT);
    }
    if (given.min_t != nullptr) room[i].min_t = number_at(given.min_t, i, stride, WINNOW_FLOAT);
    if (given.max_t != nullptr) room[i].max_t = number_at(given.max_t, i, stride, WINNOW_FLOAT);
  }
  rays = ShapeRayBatch(std::span<const ShapeRay>(room.data(), room.size()));
  return Status::ok;
}

}  // namespace winnow::c
