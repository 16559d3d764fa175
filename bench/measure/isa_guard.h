#pragma once

#include <winnow/simd/isa.h>

namespace winnow::bench {

/// Restores the instruction set that was active at its construction.
class IsaGuard {
 public:
  IsaGuard() = default;
  IsaGuard(const IsaGuard&) = delete;
  IsaGuard& operator=(const IsaGuard&) = delete;
  ~IsaGuard() { choose(before_); }

  /// Activates `isa`, which must be available on this machine.
  static void choose(Isa isa) noexcept {
    if (isa != active_isa()) static_cast<void>(set_isa(isa));
  }

 private:
  Isa before_ = active_isa();
};

}  // namespace winnow::bench
