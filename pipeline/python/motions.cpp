// Motions of bodies between two times, as rows of numbers.

#include "pipeline/python/motions.h"

#include "pipeline/python/arrays.h"
#include "pipeline/python/described.h"
#include "pipeline/python/gil.h"
#include "pipeline/python/refusal.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>

namespace winnow::python {

RigidMotion RigidMotionInput::operator[](std::size_t i) const noexcept {
  RigidMotion motion;
  for (std::size_t k = 0; k < 3; ++k) motion.start.position[k] = numbers_.at(i, k);
  for (std::size_t k = 0; k < 4; ++k) motion.start.orientation[k] = numbers_.at(i, 3 + k);
  for (std::size_t k = 0; k < 3; ++k) motion.travel[k] = numbers_.at(i, 7 + k);
  for (std::size_t k = 0; k < 3; ++k) motion.turn[k] = numbers_.at(i, 10 + k);
  return motion;
}

std::span<const RigidMotion> RigidMotionInput::packed(std::vector<RigidMotion>& room) const {
  if (!numbers_.is_single() && numbers_.is_dense(kMotionNumbers)) {
    return {reinterpret_cast<const RigidMotion*>(numbers_.column<double>(0)), count()};
  }
  room.resize(count());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = (*this)[i];
  return room;
}

std::string RigidMotionInput::fault(Status status) const {
  for (std::size_t i = 0; status == Status::invalid_pose && i < count(); ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kMotionNumbers; ++k) sum += numbers_.at(i, k);
    if (std::isnan(sum)) return place(i) + " has a NaN";
    if (!(*this)[i].is_valid()) return place(i) + " is not finite, or turns too far";
  }
  return {};
}

namespace {

/// Calls write(i) for each motion without the GIL; throws the error of the first one that fails.
template <typename Write>
void write_each(std::size_t count, const char* call, Write&& write) {
  Status status = Status::ok;
  std::size_t i = 0;
  {
    const WithoutGil release;
    for (; i < count; ++i) {
      status = write(i);
      if (status != Status::ok) break;
    }
  }
  accept(status, std::string(call) + ", motion " + std::to_string(i));
}

/// Returns rows of `count` motions; make(i) returns the i-th.
template <typename Make>
[[nodiscard]] py::array motion_rows(std::size_t count, const char* call, Make&& make) {
  auto rows = fresh<double>(count, kMotionNumbers);
  double* const to = rows.mutable_data();
  write_each(count, call, [&](std::size_t i) {
    const RigidMotion motion = make(i);
    if (!motion.is_valid()) return Status::invalid_pose;
    std::memcpy(to + i * kMotionNumbers, &motion, sizeof motion);
    return Status::ok;
  });
  return rows;
}

[[nodiscard]] py::array between(py::handle starts, py::handle ends) {
  PoseInput start(starts, "start");
  PoseInput end(ends, "end");
  return motion_rows(agree({&start, &end}), "motions_between",
                     [&](std::size_t i) { return RigidMotion::between(start[i], end[i]); });
}

[[nodiscard]] py::array by_velocities(py::handle poses, py::handle linears, py::handle angulars,
                                      py::handle durations) {
  PoseInput pose(poses);
  Numbers linear(linears, "linear", {3}, Valid::finite);
  Numbers angular(angulars, "angular", {3}, Valid::finite);
  Numbers duration(durations, "duration", {}, Valid::finite);
  const std::size_t count = agree({&pose, &linear, &angular, &duration});
  return motion_rows(count, "motions_by_velocities", [&](std::size_t i) {
    return RigidMotion::by_velocities(pose[i], linear.vector(i), angular.vector(i), duration.at(i));
  });
}

[[nodiscard]] py::array poses_at(py::handle motions, py::handle times) {
  RigidMotionInput motion(motions);
  Numbers time(times, "times", {}, Valid::fraction);
  const std::size_t count = agree({&motion, &time});
  auto rows = fresh<double>(count, 7);
  double* const to = rows.mutable_data();
  write_each(count, "poses_at", [&](std::size_t i) {
    const RigidMotion one = motion[i];
    const double t = time.at(i);
    if (!one.is_valid()) return Status::invalid_pose;
    if (!(t >= 0.0 && t <= 1.0)) return Status::invalid_argument;
    const Pose pose = one.at(t);
    static_assert(sizeof pose == 7 * sizeof(double));
    std::memcpy(to + i * 7, &pose, sizeof pose);
    return Status::ok;
  });
  return rows;
}

}  // namespace

void add_motions(py::module_& module) {
  add_function(module, "motions_between", &between);
  add_function(module, "motions_by_velocities", &by_velocities);
  add_function(module, "poses_at", &poses_at);
}

}  // namespace winnow::python
