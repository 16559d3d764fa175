#pragma once

#include <winnow/core/status.h>

#include <cstddef>
#include <string_view>

namespace winnow {

/// Tells the log, if there is one, that a call was refused.
void tell_refusal(Status status, const char* call) noexcept;

/// That a choice changed the structure of a partition.
void tell_choice(std::string_view before, std::string_view now, std::string_view reason,
                 std::size_t objects) noexcept;

/// `status`; the log is told of all but ok.
inline Status logged(Status status, const char* call) noexcept {
  if (status != Status::ok) tell_refusal(status, call);
  return status;
}

}  // namespace winnow
