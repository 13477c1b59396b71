#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace pilotfish::bus {

/// Walks over an encoded LCM message (big endian) without ever leaving it. lcm-gen's decoders do not check the
/// counts they read: a count of 2^31-1 makes them allocate before the missing bytes are detected, and
/// a string length of zero or less is used as it is. So every message with a variable length is walked first
/// and decoded only if the counts add up to exactly its size.
class WireReader {
 public:
  WireReader(const void* data, std::size_t size_bytes)
      : at_(static_cast<const std::uint8_t*>(data)), left_(size_bytes) {}

  bool skip(std::size_t bytes) {
    if (bytes > left_) return false;
    at_ += bytes;
    left_ -= bytes;
    return true;
  }

  template <class Integer>
  bool read(Integer& value) {
    if (left_ < sizeof(Integer)) return false;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) bits = bits << 8 | at_[i];
    value = static_cast<Integer>(bits);
    return skip(sizeof(Integer));
  }

  bool skip_byte_array() {  // int32 count, then as many bytes
    std::int32_t count = 0;
    return read(count) && count >= 0 && skip(static_cast<std::size_t>(count));
  }

  bool skip_string(std::size_t at_most = kNoLimit) {  // int32 length with the final zero, then as many bytes
    std::int32_t length = 0;
    return read(length) && length >= 1 && static_cast<std::size_t>(length) - 1 <= at_most &&
           skip(static_cast<std::size_t>(length));
  }

  bool at_end() const { return left_ == 0; }

 private:
  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  const std::uint8_t* at_;
  std::size_t left_;
};

}  // namespace pilotfish::bus
