#pragma once

#include <stdexcept>

namespace winnow::bench {

/// A wrong argument that only shows when a command runs. Ends the tool with 2.
class ArgumentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace winnow::bench
