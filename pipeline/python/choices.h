#pragma once

#include "pipeline/python/refusal.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace winnow::python {

/// A table of the names that Python uses for the values of an enum.
template <typename Enum, std::size_t N>
using Choices = std::array<std::pair<std::string_view, Enum>, N>;

/// Returns the value of a name; throws an invalid_argument that lists all names.
template <typename Enum, std::size_t N>
[[nodiscard]] Enum chosen(const Choices<Enum, N>& choices, std::string_view name,
                          const char* what) {
  std::string all;
  for (const auto& [known, value] : choices) {
    if (known == name) return value;
    all += (all.empty() ? "" : ", ") + std::string(known);
  }
  throw Refusal(Status::invalid_argument,
                std::string(what) + ": '" + std::string(name) + "' is none of " + all);
}

template <typename Enum, std::size_t N>
[[nodiscard]] std::string_view name_of(const Choices<Enum, N>& choices, Enum value) {
  for (const auto& [known, other] : choices) {
    if (other == value) return known;
  }
  return {};
}

}  // namespace winnow::python
