#pragma once

#include <cstddef>
#include <pilotfish/base_t.hpp>
#include <pilotfish/status_t.hpp>

#include "authentication.hpp"
#include "checked.hpp"
#include "pilotfish/bus/reports.hpp"

namespace pilotfish::bus {

inline constexpr std::size_t kOneDatagramBytes = 1400;  ///< of a state message, behind LCM's own header
inline constexpr std::size_t kMaxStages = 6;
inline constexpr std::size_t kMaxDetail = 120;  ///< letters of StatusReport::detail
inline constexpr std::size_t kMaxStageName = 12;
inline constexpr std::size_t kMaxCounters = 24;
inline constexpr std::size_t kMaxBaseCounters = 16;
inline constexpr std::size_t kMaxBaseText = 80;

/// Zeros for numbers that are not finite, the first 6 stages, and of many counters those whose turn it is.
status_t encode(const StatusReport& report, std::string_view& repaired, std::size_t turn);
/// Zeros for numbers that are not finite; a measurement that is not finite is none.
base_t encode(const BaseReport& report, std::string_view& repaired, std::size_t turn);

/// Rejections: status_corrupt, status_not_finite, status_out_of_bounds (a status or reason that we do not know).
Checked<StatusReport> decode_status(const void* data, std::size_t size_bytes);
/// Rejections: base_corrupt, base_mac_wrong, base_not_finite, base_out_of_bounds (velocities no robot of ours has, an
/// unknown state, a clock that is none).
Checked<BaseReport> decode_base(const void* data, std::size_t size_bytes, const Authentication& authentication);

}  // namespace pilotfish::bus
