#include "pilotfish/core/status.hpp"

namespace pilotfish {

std::string_view to_string(Status status) noexcept {
  switch (status) {
    case Status::searching: return "searching";
    case Status::tracking: return "tracking";
    case Status::coasting: return "coasting";
    case Status::lost: return "lost";
    case Status::stopped: return "stopped";
    case Status::invalid_input: return "invalid_input";
  }
  return "unknown";
}

std::string_view to_string(Reason reason) noexcept {
  const auto number = static_cast<std::size_t>(reason);
  return number < kReasons.size() ? kReasons[number].text : "unknown";
}

}  // namespace pilotfish
