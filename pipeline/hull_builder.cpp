#include <winnow/pipeline/hull_builder.h>

namespace winnow {
Status hull_of_faces(std::span<const Eigen::Vector3d>, const HullFaces&, std::pmr::memory_resource*,
                     HullShape&) {
  return Status::unsupported;
}
HullShape point_hull() noexcept {
  return {};
}
std::size_t hull_bytes(const HullShape&) noexcept {
  return 0;
}
void release_hull(const HullShape&, std::pmr::memory_resource*) noexcept {}
}  // namespace winnow
