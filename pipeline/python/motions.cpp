// Motions of bodies between two times, as rows of numbers.

#include "pipeline/python/motions.h"

#include "pipeline/python/gil.h"
#include "pipeline/python/refusal.h"

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
  const PoseInput start(starts);
  const PoseInput end(ends);
  if (start.count() != end.count()) {
    throw Refusal(Status::size_mismatch, "motions_between: start and end differ in length");
  }
  return motion_rows(start.count(), "motions_between",
                     [&](std::size_t i) { return RigidMotion::between(start[i], end[i]); });
}

[[nodiscard]] py::array by_velocities(py::handle poses, py::handle linears, py::handle angulars,
                                      py::handle durations) {
  const PoseInput pose(poses);
  Numbers linear(linears, "linear", {3}, true);
  Numbers angular(angulars, "angular", {3}, true);
  Numbers duration(durations, "duration", {}, true);
  for (Numbers* each : {&linear, &angular, &duration}) each->expect(pose.count());
  return motion_rows(pose.count(), "motions_by_velocities", [&](std::size_t i) {
    return RigidMotion::by_velocities(pose[i], {linear.at(i, 0), linear.at(i, 1), linear.at(i, 2)},
                                      {angular.at(i, 0), angular.at(i, 1), angular.at(i, 2)},
                                      duration.at(i));
  });
}

[[nodiscard]] py::array poses_at(py::handle motions, py::handle times) {
  const RigidMotionInput motion(motions);
  Numbers time(times, "times", {}, true);
  time.expect(motion.count());
  auto rows = fresh<double>(motion.count(), 7);
  double* const to = rows.mutable_data();
  write_each(motion.count(), "poses_at", [&](std::size_t i) {
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
  using py::arg;
  module.def("motions_between", &between, arg("start"), arg("end"),
             "Motions between poses (n, 7), (n, 3) or tuples, from time 0 to 1: (n, 13) float64 of "
             "the pose at the start (x, y, z and a quaternion w, x, y, z), the translation, and "
             "the rotation, an axis in the world times an angle in radians; both at constant "
             "speed. The rotation is the shorter one.");
  module.def("motions_by_velocities", &by_velocities, arg("poses"), arg("linear"), arg("angular"),
             arg("duration") = 1.0,
             "Motions of bodies at poses (n, 7) with velocities, linear and angular (n, 3) or "
             "(3,), in lengths and radians per unit of time, during `duration` units, (n,) or one "
             "for all. At most 1e6 radians.");
  module.def("poses_at", &poses_at, arg("motions"), arg("times"),
             "Poses of motions (n, 13) at times in [0, 1], (n,) or one for all: (n, 7) float64.");
}

}  // namespace winnow::python
