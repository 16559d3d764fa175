#include <winnow/core/status.h>

namespace winnow {

const char* to_string(Status status) noexcept {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::invalid_bounds:
      return "invalid_bounds";
    case Status::invalid_key:
      return "invalid_key";
    case Status::invalid_argument:
      return "invalid_argument";
    case Status::size_mismatch:
      return "size_mismatch";
    case Status::out_of_memory:
      return "out_of_memory";
    case Status::too_many_objects:
      return "too_many_objects";
    case Status::unsupported_volume:
      return "unsupported_volume";
    case Status::invalid_shape:
      return "invalid_shape";
    case Status::invalid_pose:
      return "invalid_pose";
    case Status::unsupported:
      return "unsupported";
    case Status::communication_failed:
      return "communication_failed";
  }
  return "unknown";
}

}  // namespace winnow
