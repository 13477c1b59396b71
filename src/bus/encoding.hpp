#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <pilotfish/counter_t.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "pilotfish/bus/reports.hpp"
#include "pilotfish/core/plausible_twist.hpp"
#include "wire_reader.hpp"

namespace pilotfish::bus {

// What the codecs of several messages share.

inline constexpr std::size_t kMaxCounterName = 24;

/// Numbers of a Status and of a Reason.
bool is_known(int status, int reason);

/// "lost: no tag in the picture"
std::string words(Status status, Reason reason);

/// Passes finite numbers through, turns others into zeros, and records that it did.
struct FiniteOrZero {
  bool repaired = false;
  double operator()(double value) {
    if (std::isfinite(value)) return value;
    repaired = true;
    return 0.0;
  }
  template <class Integer, class = std::enable_if_t<std::is_integral_v<Integer>>>
  Integer operator()(Integer value) {
    return value;
  }
};

template <class Message>
bool decode_whole(Message& message, const void* data, std::size_t size_bytes) {
  return size_bytes <= std::numeric_limits<std::int32_t>::max() &&
         message.decode(data, 0, static_cast<int>(size_bytes)) == static_cast<int>(size_bytes);
}

/// Of `counters` as many as fit into size_bytes, at most `at_most`; if that is not all of them, those whose turn it is
/// when this is message number `turn`, and one called "others" for the rest.
std::vector<counter_t> encode(const Counters& counters, std::size_t at_most, std::size_t size_bytes, std::size_t turn);

/// Walks over a list of counters behind its count; false if there are too many or a name is too long.
bool skip_counters(WireReader& reader, std::int32_t at_most);

Counters decode(const std::vector<counter_t>& messages);

}  // namespace pilotfish::bus
