#pragma once

namespace pilotfish::apps {

/// What --version prints; CMakeLists.txt's project(VERSION) says it.
inline constexpr const char* kVersion = PILOTFISH_VERSION;

}  // namespace pilotfish::apps
