#include "core/threads/float_environment.h"

namespace winnow {
namespace {

/// Modes that the outermost DefaultFloatEnvironment of this thread restores; 0 if it changed none.
thread_local FloatControl host_modes = 0;

// Both functions change only mode bits: exception flags that computations raised since `enter` stay
// set.
void add_modes(FloatControl modes) noexcept {
  set_float_control(float_control() | modes);
}
void remove_modes(FloatControl modes) noexcept {
  set_float_control(float_control() & ~modes);
}

}  // namespace

void DefaultFloatEnvironment::enter(FloatControl modes) noexcept {
  remove_modes(modes);
  host_modes = modes;
}

void DefaultFloatEnvironment::leave(FloatControl modes) noexcept {
  host_modes = 0;
  add_modes(modes);
}

HostFloatEnvironment::HostFloatEnvironment() noexcept : host_modes_(host_modes) {
  if (host_modes_ == 0) return;
  host_modes = 0;
  add_modes(host_modes_);
}

HostFloatEnvironment::~HostFloatEnvironment() {
  if (host_modes_ == 0) return;
  remove_modes(host_modes_);
  host_modes = host_modes_;
}

}  // namespace winnow
