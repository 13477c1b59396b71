#pragma once

// One object serves one thread, as docs/library.md says; Python's threads are held to it here. A method that releases
// the interpreter's lock would else let another thread into the same object, and so would a callback that calls back.

#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>
#include <type_traits>
#include <unordered_set>
#include <utility>

namespace pilotfish::python {

namespace py = pybind11;

/// While it lives, its object is in use; RuntimeError if it is already. Made and destroyed under the interpreter's
/// lock, which is what guards the set.
class InUse {
 public:
  template <class Object>
  explicit InUse(const Object& object) : object_(&object) {
    if (objects().insert(object_).second) return;
    const std::string name = py::str(py::type::of<Object>().attr("__name__"));
    throw std::runtime_error(name + " is in use by another call: one object serves one thread");
  }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;
  ~InUse() { objects().erase(object_); }

 private:
  /// Of this module: its classes are bound nowhere else.
  static std::unordered_set<const void*>& objects() {
    static std::unordered_set<const void*> in_use;
    return in_use;
  }
  const void* object_;
};

struct KeepLock {};

template <class Lock, class Call, class Result, class Self, class... Arguments>
auto exclusive_call(Call call, Result (*)(Self, Arguments...)) {
  return [call](Self self, Arguments... arguments) -> Result {
    const InUse in_use(self);
    [[maybe_unused]] const Lock lock{};
    return call(self, std::forward<Arguments>(arguments)...);
  };
}

template <class Lock, class Call, std::enable_if_t<!std::is_member_function_pointer_v<Call>, int> = 0>
auto exclusive_as(Call call) {
  return exclusive_call<Lock>(call, static_cast<py::detail::function_signature_t<Call>*>(nullptr));
}
template <class Lock, class Result, class Self, class... Arguments>
auto exclusive_as(Result (Self::*method)(Arguments...)) {
  return exclusive_as<Lock>([method](Self& self, Arguments... arguments) -> Result {
    return (self.*method)(std::forward<Arguments>(arguments)...);
  });
}
template <class Lock, class Result, class Self, class... Arguments>
auto exclusive_as(Result (Self::*method)(Arguments...) const) {
  return exclusive_as<Lock>([method](const Self& self, Arguments... arguments) -> Result {
    return (self.*method)(std::forward<Arguments>(arguments)...);
  });
}

/// A method, or a lambda whose first argument is the object, that only one call at a time may be in.
template <class Call>
auto exclusive(Call call) {
  return exclusive_as<KeepLock>(call);
}
/// The same without the interpreter's lock: other threads run meanwhile.
template <class Call>
auto exclusive_unlocked(Call call) {
  return exclusive_as<py::gil_scoped_release>(call);
}

}  // namespace pilotfish::python
