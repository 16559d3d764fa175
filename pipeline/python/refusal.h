#pragma once

#include <winnow/core/status.h>

#include <stdexcept>
#include <string>

namespace winnow::python {

/// An exception that becomes a `winnow.StatusError` in Python, or a MemoryError for
/// `out_of_memory`.
class Refusal : public std::runtime_error {
 public:
  Refusal(Status status, const std::string& what)
      : std::runtime_error(std::string(to_string(status)) + ": " + what), status_(status) {}
  [[nodiscard]] Status status() const noexcept { return status_; }

 private:
  Status status_;
};

/// Throws unless the status is ok.
void accept(Status status, const std::string& what);

/// Describes a status in one sentence.
[[nodiscard]] const char* meaning(Status status) noexcept;

}  // namespace winnow::python
