#pragma once

#include <winnow/core/status.h>

#include <cstddef>
#include <string_view>

namespace winnow {

/// Reports a refused call to the log hook, if there is one.
void log_refusal(Status status, const char* call) noexcept;

/// Reports to the log hook that `automatic()` changed the structure of a partition.
void log_choice(std::string_view before, std::string_view now, std::string_view reason,
                std::size_t objects) noexcept;

/// Returns `status`, and reports it to the log hook unless it is ok.
inline Status logged(Status status, const char* call) noexcept {
  if (status != Status::ok) log_refusal(status, call);
  return status;
}

}  // namespace winnow
