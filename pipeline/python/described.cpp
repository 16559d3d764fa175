// What the stubs state about definitions. See described.h.

#include "pipeline/python/described.h"

#include <pybind11/eval.h>

#include <algorithm>
#include <limits>
#include <string>

namespace winnow::python {

const Description& described(std::string_view owner, std::string_view name) {
  const std::string full =
      owner.empty() ? std::string(name) : std::string(owner) + "." + std::string(name);
  const auto found = std::ranges::lower_bound(descriptions(), full, {}, &Description::name);
  if (found != descriptions().end() && found->name == full) return *found;
  throw py::import_error("the stubs lack " + full);
}

namespace {

/// Returns the value of a default.
[[nodiscard]] py::object evaluated(const char* expression) {
  py::dict names;
  names["inf"] = std::numeric_limits<double>::infinity();
  return py::eval(expression, names);
}

}  // namespace
}  // namespace winnow::python

namespace pybind11::detail {

void process_attribute<winnow::python::FromStub>::init(const winnow::python::FromStub&,
                                                       function_record* record) {
  using namespace winnow::python;
  const std::string owner =
      record->is_method ? cast<std::string>(record->scope.attr("__name__")) : std::string();
  const Description& stub = described(owner, record->name);
  const std::size_t expected = record->nargs_pos;
  record->doc = const_cast<char*>(stub.text);  // copied, not changed
  append_self_arg_if_needed(record);
  for (const Parameter& parameter : stub.parameters) {
    if (std::string_view(parameter.name) == "*") {
      process_attribute<kw_only>::init({}, record);
      continue;
    }
    if (parameter.value == nullptr) {
      process_attribute<arg>::init(arg(parameter.name).none(parameter.may_be_none), record);
    } else {
      process_attribute<arg_v>::init(arg_v(parameter.name, evaluated(parameter.value)), record);
    }
  }
  if (record->args.size() == expected) return;
  throw import_error("the stub of " + std::string(stub.name) + " has " +
                     std::to_string(record->args.size()) + " arguments, the function " +
                     std::to_string(expected));
}

}  // namespace pybind11::detail
