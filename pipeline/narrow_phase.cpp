#include <winnow/pipeline/narrow_phase.h>

namespace winnow {

NarrowPhase::NarrowPhase(std::pmr::memory_resource* memory) noexcept
    : memory_(memory), sorted_(memory), kinds_(memory), uncertified_(memory) {}

Status NarrowPhase::collide(const ShapePool&, const Bodies&, std::span<const BodyPair>,
                            const NarrowOptions&, NarrowResult&) {
  return Status::unsupported;
}

Footprint NarrowPhase::footprint() const noexcept {
  Footprint footprint;
  footprint.scratch += sorted_.bytes();
  footprint.scratch += kinds_.bytes();
  footprint.scratch += uncertified_.bytes();
  return footprint;
}

}  // namespace winnow
