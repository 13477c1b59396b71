#include "pilotfish/vision/rejection_counters.hpp"

#include <algorithm>

namespace pilotfish::vision {
namespace {

template <class Combine>
RejectionCounters combined(const RejectionCounters& a, const RejectionCounters& b, Combine combine) {
  RejectionCounters result;
  for (const RejectionCounters::Named& each : RejectionCounters::all())
    result.*each.count = combine(a.*each.count, b.*each.count);
  return result;
}

}  // namespace

Reason RejectionCounters::count(TagRefusal refusal, Reason otherwise) noexcept {
  std::int64_t RejectionCounters::*const counter = kTagRefusals[static_cast<std::size_t>(refusal)].counter;
  if (counter == nullptr) return otherwise;
  ++(this->*counter);
  for (const Named& each : all())
    if (each.count == counter) return each.reason;
  return otherwise;
}

void RejectionCounters::count_pose(Reason refusal) noexcept {
  for (const Named& each : all())
    if (each.reason == refusal) {
      ++(this->*each.count);
      return;
    }
  ++pose;
}

RejectionCounters sum_of(const RejectionCounters& a, const RejectionCounters& b) noexcept {
  return combined(a, b, [](std::int64_t x, std::int64_t y) { return x + y; });
}

RejectionCounters larger_of_each(const RejectionCounters& a, const RejectionCounters& b) noexcept {
  return combined(a, b, [](std::int64_t x, std::int64_t y) { return std::max(x, y); });
}

}  // namespace pilotfish::vision
