#pragma once

#include <gtest/gtest.h>
#include <winnow/core/status.h>

#include <concepts>

namespace winnow::test {

/// Returns the value of an answer, and fails the test if it is an error.
template <typename T>
T expect_ok(const Answer<T>& answer) {
  EXPECT_EQ(answer.status, Status::ok);
  return answer;
}

/// Fails the test unless the answer is this error, with the default value.
template <typename T>
void expect_error(const Answer<T>& answer, Status error) {
  EXPECT_EQ(answer.status, error);
  if constexpr (std::equality_comparable<T>) {
    EXPECT_EQ(static_cast<const T&>(answer), T{});
  } else if constexpr (requires { answer.empty(); }) {
    EXPECT_TRUE(answer.empty());
  } else if constexpr (requires { static_cast<bool>(answer); }) {
    EXPECT_FALSE(answer);
  }
}

}  // namespace winnow::test
