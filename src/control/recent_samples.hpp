#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {

/// Puts `next`, which has a `utime`, behind the recent ones, a BoundedVector, and the oldest out if it is full. One
/// that is not newer than the last, or comes after a gap of more than longest_gap_s, begins anew. Whether it is full
/// now.
template <class Recent, class Value>
bool append_in_time(Recent& recent, const Value& next, double longest_gap_s) noexcept {
  if (!recent.empty()) {
    const double passed_s = seconds_between(recent.back().utime, next.utime);
    if (!(passed_s > 0.0) || passed_s > longest_gap_s) recent.clear();
  }
  if (recent.full()) recent.pop_front();
  recent.push_back(next);
  return recent.full();
}

/// The value below which that share, in [0, 1), of what `value_of` makes of at most `kMax` samples lies. There must be
/// one.
template <std::size_t kMax, class Samples, class ValueOf>
double quantile(const Samples& samples, double share, const ValueOf& value_of) noexcept {
  std::array<double, kMax> values{};
  std::size_t count = 0;
  for (const auto& each : samples) values[count++] = value_of(each);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(count));
  std::nth_element(values.begin(), at, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *at;
}

}  // namespace pilotfish::control
