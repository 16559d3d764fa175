#include "core/threads/float_environment.h"

namespace winnow {
namespace {

/// Modes that the outermost DefaultEnvironment of this thread restores; 0 if it changed none.
thread_local FloatControl host_modes = 0;

// Only mode bits change: exception flags that were raised in between stay set.
void add_modes(FloatControl modes) noexcept {
  set_float_control(float_control() | modes);
}
void remove_modes(FloatControl modes) noexcept {
  set_float_control(float_control() & ~modes);
}

}  // namespace

void DefaultEnvironment::enter(FloatControl modes) noexcept {
  remove_modes(modes);
  host_modes = modes;
}

void DefaultEnvironment::leave(FloatControl modes) noexcept {
  host_modes = 0;
  add_modes(modes);
}

HostEnvironment::HostEnvironment() noexcept : hosts_(host_modes) {
  if (hosts_ == 0) return;
  host_modes = 0;
  add_modes(hosts_);
}

HostEnvironment::~HostEnvironment() {
  if (hosts_ == 0) return;
  remove_modes(hosts_);
  host_modes = hosts_;
}

}  // namespace winnow
