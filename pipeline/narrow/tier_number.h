#pragma once

// The numbers of the tiers in files. 0 is a retired tier and is read as robust.

#include <winnow/pipeline/narrow_phase.h>
#include "core/memory/byte_stream.h"

namespace winnow {

inline constexpr std::uint8_t kRobustNumber = 1;
inline constexpr std::uint8_t kReferenceNumber = 2;

[[nodiscard]] constexpr std::uint8_t tier_number(NarrowTier tier) noexcept {
  return tier == NarrowTier::reference ? kReferenceNumber : kRobustNumber;
}

[[nodiscard]] inline NarrowTier read_tier(ByteReader& in) noexcept {
  const auto number = in.get<std::uint8_t>();
  if (number > kReferenceNumber) in.fail();
  return number == kReferenceNumber ? NarrowTier::reference : NarrowTier::robust;
}

}  // namespace winnow
