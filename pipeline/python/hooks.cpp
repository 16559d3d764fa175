// Hooks for profilers and logs, which call Python functions.

#include "pipeline/python/hooks.h"

#include "pipeline/python/callbacks.h"

#include <winnow/core/hooks.h>

#include <string>
#include <utility>

namespace winnow::python {
namespace {

/// A function that winnow calls for the whole process, from any thread. Used with the GIL. Never
/// destroyed, because winnow may call it until the process ends.
struct Hook {
  PyObject* function = nullptr;

  /// Replaces the function; None removes it. Returns the old one.
  [[nodiscard]] py::object exchange(const py::object& other, const char* name) {
    if (!other.is_none() && PyCallable_Check(other.ptr()) == 0) {
      throw py::type_error(std::string(name) + ": expected a callable or None");
    }
    PyObject* const before =
        std::exchange(function, other.is_none() ? nullptr : py::object(other).release().ptr());
    return before == nullptr ? py::none() : py::reinterpret_steal<py::object>(before);
  }

  /// Calls the function with arguments(). Exceptions go to `sys.unraisablehook`.
  template <typename Arguments>
  void call(Arguments&& arguments) const noexcept {
    call_python(
        [&] {
          const py::error_scope other;
          if (function == nullptr) return;
          const auto called = py::reinterpret_borrow<py::object>(function);
          called(*py::tuple(arguments()));
        },
        [&] {
          const py::error_scope other;
          const py::object raised = caught_exception();
          PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(raised.ptr())), raised.ptr());
          PyErr_WriteUnraisable(function);
        });
  }
};

Hook stages;
Hook log;

[[nodiscard]] py::str text(std::string_view words) {
  return {words.data(), words.size()};
}

void call_stage_hook(WorkStage stage, bool begins) {
  stages.call([&] { return py::make_tuple(to_string(stage), begins); });
}

void call_log_hook(const LogEntry& entry) {
  log.call([&] {
    py::dict fields;
    const bool is_choice = entry.kind == LogEntry::Kind::choice;
    fields["kind"] = is_choice ? "choice" : "refusal";
    fields["what"] = text(entry.what);
    fields["reason"] = text(entry.reason);
    if (is_choice) {
      fields["before"] = text(entry.before);
      fields["objects"] = entry.objects;
    } else {
      fields["status"] = to_string(entry.status);
    }
    return py::make_tuple(fields);
  });
}

[[nodiscard]] py::object exchange_stage_hook(const py::object& hook) {
  py::object before = stages.exchange(hook, "hook");
  set_stage_hook(hook.is_none() ? nullptr : &call_stage_hook);
  return before;
}

[[nodiscard]] py::object exchange_log_hook(const py::object& hook) {
  py::object before = log.exchange(hook, "hook");
  set_log_hook(hook.is_none() ? nullptr : &call_log_hook);
  return before;
}

}  // namespace

void add_hooks(py::module_& module) {
  add_function(module, "set_stage_hook", &exchange_stage_hook);
  add_function(module, "set_log_hook", &exchange_log_hook);
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    set_stage_hook(nullptr);
    set_log_hook(nullptr);
    InterpreterEnd::begin();
  }));
}

}  // namespace winnow::python
