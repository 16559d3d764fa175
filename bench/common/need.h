#pragma once

#include <winnow/core/status.h>

#include <stdexcept>
#include <string>

namespace winnow::bench {

/// Throws std::runtime_error unless `status` is ok.
inline void need(Status status, const char* what) {
  if (status != Status::ok) throw std::runtime_error(std::string(what) + ": " + to_string(status));
}
/// Returns the value of an answer; throws std::runtime_error for an error.
template <typename T>
T need(const Answer<T>& answer, const char* what) {
  need(answer.status, what);
  return answer;
}

}  // namespace winnow::bench
