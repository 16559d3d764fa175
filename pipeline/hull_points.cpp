#include <winnow/pipeline/hull_builder.h>

namespace winnow {
Status hull_of_points(std::span<const Eigen::Vector3d>, std::pmr::memory_resource*, HullShape&) {
  return Status::unsupported;
}
}  // namespace winnow
