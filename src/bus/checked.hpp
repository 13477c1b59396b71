#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

namespace pilotfish::bus {

/// A received value that passed every check, or the name of the check that it failed (as
/// counted in Bus::rejected()). Both, if only a part of it can be accepted.
template <class Value>
struct Checked {
  std::optional<Value> value;
  std::string_view rejection;

  static Checked accept(Value value) { return {std::move(value), {}}; }
  static Checked repair(Value value, std::string_view rejection) { return {std::move(value), rejection}; }
  static Checked reject(std::string_view rejection) { return {std::nullopt, rejection}; }
};

/// Of a message's utime: half of the range, so that a difference of two times cannot overflow.
inline bool is_usable_time(std::int64_t utime) {
  return utime >= 0 && utime <= std::numeric_limits<std::int64_t>::max() / 2;
}

}  // namespace pilotfish::bus
