#pragma once

namespace winnow::bench {

/// Base of abstract classes, whose objects are not copied.
class Interface {
 public:
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  virtual ~Interface() = default;

 protected:
  Interface() = default;
};

}  // namespace winnow::bench
