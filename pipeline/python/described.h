#pragma once

// Definitions of classes and functions of the module. Their arguments, defaults and documentation
// are those of the stubs, winnow/_core.pyi, from which the script `describe` makes a table.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <span>
#include <string_view>
#include <utility>

namespace winnow::python {

namespace py = pybind11;

/// An argument of a function; "*" stands before arguments that are given by name only.
struct Parameter {
  const char* name;
  /// A Python expression; null if there is no default.
  const char* value;
  bool may_be_none;
};

/// The stub of a class, function or property.
struct Description {
  /// Such as "Partition.insert".
  std::string_view name;
  /// The documentation, after the signature in the form of `__text_signature__`.
  const char* text;
  std::span<const Parameter> parameters;
};

/// All stubs, sorted by name.
[[nodiscard]] std::span<const Description> descriptions() noexcept;
/// The stub of a name, of `owner` if that is not empty. Throws an ImportError if there is none.
[[nodiscard]] const Description& described(std::string_view owner, std::string_view name);

/// An extra of pybind11 that adds what the stub states.
struct FromStub {};

/// A class of the module.
template <typename T, typename Holder = std::shared_ptr<T>>
class Class : public py::class_<T, Holder> {
  using Base = py::class_<T, Holder>;

 public:
  Class(py::handle scope, const char* name)
      : Base(scope, name, described({}, name).text), name_(name) {}

  template <typename Function>
  Class& def(const char* name, Function&& function) {
    Base::def(name, std::forward<Function>(function), FromStub{});
    return *this;
  }
  /// Adds a constructor, a `py::init`.
  template <typename Init>
  Class& def(Init&& init) {
    Base::def(std::forward<Init>(init), FromStub{});
    return *this;
  }
  template <typename Getter>
  Class& property(const char* name, Getter&& getter) {
    Base::def_property_readonly(name, std::forward<Getter>(getter), described(name_, name).text);
    return *this;
  }

 private:
  std::string_view name_;
};

template <typename Function>
void add_function(py::module_& module, const char* name, Function&& function) {
  module.def(name, std::forward<Function>(function), FromStub{});
}

}  // namespace winnow::python

namespace pybind11::detail {

template <>
struct process_attribute<winnow::python::FromStub>
    : process_attribute_default<winnow::python::FromStub> {
  static void init(const winnow::python::FromStub& stub, function_record* record);
};

}  // namespace pybind11::detail
