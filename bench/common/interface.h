#pragma once

#include <string>

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

/// As above, for objects with names.
class NamedInterface : public Interface {
 public:
  /// Returns a short name, which is equal in each call.
  [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace winnow::bench
