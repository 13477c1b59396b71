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

const std::array<RejectionCounters::Named, 13>& RejectionCounters::all() noexcept {
  using C = RejectionCounters;
  static const std::array<Named, 13> table = {{{"frames_invalid", &C::frames_invalid},
                                               {"tag_hamming", &C::hamming},
                                               {"tag_margin", &C::margin},
                                               {"tag_residual", &C::residual},
                                               {"tag_foreign_id", &C::foreign_id},
                                               {"tag_duplicate_id", &C::duplicate_id},
                                               {"tag_outside_frame", &C::outside_frame},
                                               {"tag_too_small", &C::too_small},
                                               {"tag_too_blurred", &C::too_blurred},
                                               {"tag_size", &C::size},
                                               {"pose_behind", &C::behind},
                                               {"pose_jump", &C::jump},
                                               {"pose", &C::pose}}};
  return table;
}

Reason RejectionCounters::count(TagRefusal refusal, Reason otherwise) noexcept {
  switch (refusal) {
    case TagRefusal::not_found: return otherwise;
    case TagRefusal::outside_frame: ++outside_frame; return Reason::tag_outside_frame;
    case TagRefusal::too_small: ++too_small; return Reason::tag_too_small;
    case TagRefusal::too_blurred: ++too_blurred; return Reason::tag_too_blurred;
    case TagRefusal::hamming: ++hamming; return Reason::tag_refused;
    case TagRefusal::margin: ++margin; return Reason::tag_refused;
    case TagRefusal::residual: ++residual; return Reason::tag_refused;
  }
  return otherwise;
}

void RejectionCounters::count_pose(Reason refusal) noexcept {
  switch (refusal) {
    case Reason::tag_size_implausible: ++size; return;
    case Reason::leader_behind_camera: ++behind; return;
    case Reason::leader_jumped: ++jump; return;
    default: ++pose; return;
  }
}

RejectionCounters sum_of(const RejectionCounters& a, const RejectionCounters& b) noexcept {
  return combined(a, b, [](std::int64_t x, std::int64_t y) { return x + y; });
}

RejectionCounters larger_of_each(const RejectionCounters& a, const RejectionCounters& b) noexcept {
  return combined(a, b, [](std::int64_t x, std::int64_t y) { return std::max(x, y); });
}

}  // namespace pilotfish::vision
