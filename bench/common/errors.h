#pragma once

#include <stdexcept>

namespace winnow::bench {

/// A wrong argument that is found only while a command runs. The tool then exits with status 2.
class ArgumentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace winnow::bench
