#include "pilotfish/vision/stage_stopwatch.hpp"

namespace pilotfish::vision {

std::string_view to_string(Stage stage) noexcept {
  switch (stage) {
    case Stage::predict: return "predict";
    case Stage::detect: return "detect";
    case Stage::search: return "search";
    case Stage::align: return "align";
    case Stage::read: return "read";
    case Stage::pose: return "pose";
    case Stage::heading: return "heading";
  }
  return "unknown";
}

}  // namespace pilotfish::vision
