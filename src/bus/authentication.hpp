#pragma once

#include <string_view>

#include "pilotfish/bus/key.hpp"

namespace pilotfish::bus {

/// Distinguishes a message from a forged one, if a key is configured. The channel is included, so that a message
/// to one robot cannot be replayed to another.
struct Authentication {
  const Key* key = nullptr;  ///< none: everyone is accepted
  std::string_view channel;

  bool is_right(const void* encoded, std::size_t size_bytes) const {
    return key == nullptr || has_right_mac(*key, channel, encoded, size_bytes);
  }
};

}  // namespace pilotfish::bus
