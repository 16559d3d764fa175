#include "core/threads/float_environment.h"

namespace winnow {
namespace {

/// What the outermost DefaultEnvironment of this thread gives back; 0 if that changed nothing.
thread_local FloatControl host_modes = 0;

// Exceptions that were raised meanwhile stay raised.
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
