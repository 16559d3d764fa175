#include <winnow/pipeline/narrow/contact_patch.h>

namespace winnow {

std::uint32_t contact_patch(const Patch&, const Patch&, const double[3], double,
                            ContactPoint*) noexcept {
  return 0;
}

}  // namespace winnow
