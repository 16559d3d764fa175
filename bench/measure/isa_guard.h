#pragma once

#include <winnow/simd/isa.h>

namespace winnow::bench {

/// Puts back the instruction set that was active.
class IsaGuard {
 public:
  IsaGuard() = default;
  IsaGuard(const IsaGuard&) = delete;
  IsaGuard& operator=(const IsaGuard&) = delete;
  ~IsaGuard() { choose(before_); }

  /// One that this machine has, for which the choice cannot be refused.
  static void choose(Isa isa) noexcept {
    if (isa != active_isa()) static_cast<void>(set_isa(isa));
  }

 private:
  Isa before_ = active_isa();
};

}  // namespace winnow::bench
