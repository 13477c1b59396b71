#pragma once

#include <string_view>

#include "pilotfish/bus/key.hpp"

namespace pilotfish::bus {

/// By what a message is told from a forged one, if a key is configured. The channel belongs to it, so that what was
/// said to one robot cannot be repeated to another.
struct Authentication {
  const Key* key = nullptr;  ///< none: everyone is accepted
  std::string_view channel;

  bool is_right(const void* encoded, std::size_t size_bytes) const {
    return key == nullptr || has_right_mac(*key, channel, encoded, size_bytes);
  }
};

}  // namespace pilotfish::bus
