#pragma once

#include "pipeline/python/refusal.h"

#include <pybind11/pybind11.h>

#include <cstddef>
#include <span>

namespace winnow::python {

/// The contents of a contiguous bytes-like object, which this keeps alive.
class BytesInput {
 public:
  explicit BytesInput(const pybind11::buffer& object) : info_(object.request()) {
    pybind11::ssize_t step = info_.itemsize;
    for (pybind11::ssize_t axis = info_.ndim; axis-- > 0;) {
      if (info_.shape[static_cast<std::size_t>(axis)] != 1 &&
          info_.strides[static_cast<std::size_t>(axis)] != step) {
        throw Refusal(Status::invalid_argument, "data: not in one piece");
      }
      step *= info_.shape[static_cast<std::size_t>(axis)];
    }
  }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
    return {static_cast<const std::byte*>(info_.ptr),
            static_cast<std::size_t>(info_.size * info_.itemsize)};
  }

 private:
  pybind11::buffer_info info_;
};

}  // namespace winnow::python
