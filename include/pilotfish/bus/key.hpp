#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::bus {

/// The key that authenticates commands and setpoints, shared by all authorised senders. Wiped on destruction.
class Key {
 public:
  static constexpr std::size_t kBytes = 32;  ///< length of a key

  /// A key of these bytes; load_key() reads one from a file.
  explicit Key(const std::array<std::uint8_t, kBytes>& bytes) : bytes_(bytes) {}
  Key(const Key&) = default;             ///< copied and wiped like the original
  Key& operator=(const Key&) = default;  ///< copied and wiped like the original
  ~Key();

  const std::array<std::uint8_t, kBytes>& bytes() const { return bytes_; }  ///< the secret: never to be logged

 private:
  std::array<std::uint8_t, kBytes> bytes_;
};

/// From a file of 64 hex digits (a line end may follow; `pilotfish key new FILE` makes one). Throws
/// ConfigError("key_file") if it cannot be read, holds anything else, or may be read by others than its owner.
Key load_key(const std::string& path);

using Mac = std::array<std::uint8_t, 32>;

/// crypto_auth (libsodium), that is HMAC-SHA-512 cut off after 32 bytes, of: the channel's name, a zero byte, and the
/// encoded message with zeros in its last field, the mac. `encoded` is the whole message, with any mac;
/// one shorter than a mac has none, and the result matches nothing.
Mac message_mac(const Key& key, std::string_view channel, const void* encoded, std::size_t size_bytes);

/// Compares the message's own mac (its last 32 bytes) in constant time.
bool has_right_mac(const Key& key, std::string_view channel, const void* encoded, std::size_t size_bytes);

/// A session: drawn at random by the kernel, positive. Two programs draw the same one once in 2^63.
std::int64_t new_session_id();

}  // namespace pilotfish::bus
PILOTFISH_API_END
