#pragma once

#if __cplusplus < 201703L
#error "Pilotfish needs C++17: compile with -std=c++17 or later"
#endif

/// Around the declarations of every public header: a shared library of Pilotfish shows these and hides the rest.
#define PILOTFISH_API_BEGIN _Pragma("GCC visibility push(default)")
#define PILOTFISH_API_END _Pragma("GCC visibility pop")
