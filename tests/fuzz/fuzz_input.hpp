#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>

namespace pilotfish::fuzz {

/// Ends the program, as a sanitizer would, when what must always hold does not.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "broken: " << what << '\n';
  std::abort();
}

/// Takes numbers and bytes off a fuzzer's input; zeros and nothing at its end.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size_bytes) : at_(data), left_(size_bytes) {}

  bool empty() const { return left_ == 0; }
  const std::uint8_t* data() const { return at_; }
  std::size_t left() const { return left_; }

  std::uint32_t number(std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      value = value << 8 | (left_ > 0 ? *at_ : 0);
      skip(1);
    }
    return value;
  }

  /// At most so many bytes; `taken` says how many.
  const std::uint8_t* bytes(std::size_t wanted, std::size_t& taken) {
    const std::uint8_t* begin = at_;
    taken = std::min(wanted, left_);
    skip(taken);
    return begin;
  }

 private:
  void skip(std::size_t bytes) {
    bytes = std::min(bytes, left_);
    at_ += bytes;
    left_ -= bytes;
  }

  const std::uint8_t* at_;
  std::size_t left_;
};

}  // namespace pilotfish::fuzz
