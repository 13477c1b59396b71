#pragma once

#include <cstdio>
#include <exception>

#include "exit_codes.hpp"

namespace pilotfish::apps {

/// What a main does, with a handler for uncaught exceptions: one line on stderr and kSoftware, instead of an abort
/// that leaves a core dump and no word. By stdio, which needs no memory.
template <class Body>
int guarded(const char* program, const Body& body) noexcept {
  try {
    return body();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
  } catch (...) {
    std::fprintf(stderr, "%s: failed for an unknown reason\n", program);
  }
  return kSoftware;
}

}  // namespace pilotfish::apps
