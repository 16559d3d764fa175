// Storing and raising exceptions of Python functions.

#include "pipeline/python/callbacks.h"

#include <exception>
#include <new>
#include <string>

namespace winnow::python {

py::object caught_exception() noexcept {
  try {
    throw;
  } catch (py::error_already_set& error) {
    error.restore();
  } catch (const py::builtin_exception& error) {
    error.set_error();
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_RuntimeError, error.what());
  }
  PyObject* type = nullptr;
  PyObject* value = nullptr;
  PyObject* trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  PyErr_NormalizeException(&type, &value, &trace);
  if (trace != nullptr) PyException_SetTraceback(value, trace);
  Py_XDECREF(type);
  Py_XDECREF(trace);
  return py::reinterpret_steal<py::object>(value);
}

void raise(const py::object& exception) {
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception.ptr())), exception.ptr());
  throw py::error_already_set();
}

void Raised::keep() noexcept {
  const py::object exception = caught_exception();
  if (calls_ != 0) {
    // The old exception is released last: that may run Python code.
    const py::object gone = std::exchange(last_, exception);
    ++count_;
    return;
  }
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception.ptr())), exception.ptr());
  PyErr_WriteUnraisable(nullptr);
}

Raised::CallScope::~CallScope() {
  if (--all_.calls_ == 0) const py::object gone = std::exchange(all_.last_, py::object());
}

void Raised::CallScope::raise() const {
  if (all_.count_ != before_) python::raise(py::object(all_.last_));
}

PythonFunction::PythonFunction(py::object function, const char* name)
    : function_(std::move(function)) {
  if (PyCallable_Check(function_.ptr()) == 0) {
    throw py::type_error(std::string(name) + ": expected a callable");
  }
}

PythonFunction::~PythonFunction() {
  const WithGil hold;
  function_ = py::object();
}

bool Predicate::passes(std::uint64_t first, std::uint64_t second) noexcept {
  if (has_failed()) return false;
  bool answer = false;
  function_.call(
      [&](const py::object& function) {
        const py::object result = function(first, second);
        const int truth = PyObject_IsTrue(result.ptr());
        if (truth < 0) throw py::error_already_set();
        answer = truth != 0;
      },
      [&] {
        const py::object gone = std::exchange(raised_, caught_exception());
        has_failed_.store(true, std::memory_order_relaxed);
      });
  return answer;
}

void Predicate::raise() {
  const py::object exception = std::exchange(raised_, py::object());
  // Another call that failed meanwhile may have raised it.
  if (!exception) throw std::runtime_error("a predicate raised an exception");
  python::raise(exception);
}

PairPredicate pair_predicate(Predicate& predicate) noexcept {
  return {[](void* context, ObjectId first, ObjectId second) {
            return static_cast<Predicate*>(context)->passes(first, second);
          },
          &predicate};
}

}  // namespace winnow::python
