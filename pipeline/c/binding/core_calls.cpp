// Generated from pipeline/interface/core.toml; do not edit.
// clang-format off

#include <winnow/c/core.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_set_isa(const char* name) {
  if (!(are_given(name))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (set_isa(std::string_view(name))); });
}
