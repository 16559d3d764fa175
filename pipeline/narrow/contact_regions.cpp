#include "pipeline/narrow/contact_regions.h"

namespace winnow {

ContactRegions::ContactRegions(std::pmr::memory_resource* memory) noexcept
    : regions(memory), first(memory), count(memory), scratch(memory) {}

void ContactRegions::clear() noexcept {
  regions.clear();
  first.clear();
  count.clear();
  scratch.clear();
}

Footprint ContactRegions::footprint() const noexcept {
  Footprint footprint;
  footprint.results += regions.bytes();
  footprint.results += first.bytes();
  footprint.results += count.bytes();
  footprint.scratch += scratch.bytes();
  return footprint;
}

}  // namespace winnow
