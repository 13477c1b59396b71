#pragma once

// Ctrl-C and sys.exit() inside a law written in Python. A law is called from code that must not throw, so what it
// raises stands the robot still; but KeyboardInterrupt and SystemExit are re-raised: such an exception is kept in the
// dict of Python's thread, which every module sees, until the call from Python that led to the law returns.

#include <pybind11/pybind11.h>

#include <utility>

namespace pilotfish::python {

namespace py = pybind11;

inline constexpr const char* kLawException = "pilotfish.law_exception";

/// Keeps what is no `Exception`: KeyboardInterrupt, SystemExit. False, and nothing is kept, for all others.
inline bool keep_law_exception(const py::error_already_set& error) {
  if (error.matches(PyExc_Exception)) return false;
  PyObject* const thread = PyThreadState_GetDict();
  return thread != nullptr && PyDict_SetItemString(thread, kLawException, error.value().ptr()) == 0;
}

/// Raises what was kept in this thread. Called where C++ returns to Python.
inline void raise_law_exception() {
  PyObject* const thread = PyThreadState_GetDict();
  PyObject* const kept = thread != nullptr ? PyDict_GetItemString(thread, kLawException) : nullptr;
  if (kept == nullptr) return;
  const auto exception = py::reinterpret_borrow<py::object>(kept);
  PyDict_DelItemString(thread, kLawException);
  PyErr_SetObject(py::type::handle_of(exception).ptr(), exception.ptr());
  throw py::error_already_set();
}

/// What a call that may run a law returns.
template <class Call>
auto raising_law_exceptions(Call&& call) {
  auto result = std::forward<Call>(call)();
  raise_law_exception();
  return result;
}

}  // namespace pilotfish::python
