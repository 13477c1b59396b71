// The first byte says which message the rest is; what gets through is within its bounds. From 132 up, the message's
// fingerprint is put in front, which a fuzzer does not guess.
#include <cmath>

#include "encoding.hpp"
#include "fuzz_input.hpp"
#include "report_codec.hpp"
#include "status_codec.hpp"

using namespace pilotfish;
using namespace pilotfish::bus;

namespace {

void require_sound(const Twist& twist) {
  fuzz::require(std::isfinite(twist.linear_mps) && std::isfinite(twist.angular_radps), "a twist is finite");
  fuzz::require(std::abs(twist.angular_radps) <= kMaxPlausibleTwist.angular_radps, "a turn rate is within its bounds");
}

template <class Message>
std::vector<std::uint8_t> message_of(const fuzz::FuzzInput& input, bool fingerprint) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(input.left() + (fingerprint ? 8 : 0));  // exactly: the sanitizer sees a step behind its end
  if (fingerprint)
    for (int shift = 56; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(Message::getHash()) >> shift));
  bytes.insert(bytes.end(), input.data(), input.data() + input.left());
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput input(data, size);
  const std::uint32_t which = input.number(1);
  const bool fingerprint = which >= 132;
  switch (which % 6) {
    case 0: {
      const auto bytes = message_of<setpoint_t>(input, fingerprint);
      if (const auto setpoint = decode_setpoint(bytes.data(), bytes.size(), {}); setpoint.value)
        check_ranges(setpoint.value->setpoint, "setpoint");  // throws, if it does not hold
      break;
    }
    case 1: {
      const auto bytes = message_of<command_t>(input, fingerprint);
      if (const auto command = decode_command(bytes.data(), bytes.size(), {}); command.value)
        require_sound(command.value->command);
      break;
    }
    case 2: {
      const auto bytes = message_of<bot_core::pose_t>(input, fingerprint);
      if (const auto pose = decode_pose(bytes.data(), bytes.size()); pose.value) require_sound(pose.value->twist);
      break;
    }
    case 3: {
      const auto bytes = message_of<motion_t>(input, fingerprint);
      if (const auto motion = decode_motion(bytes.data(), bytes.size()); motion.value)
        require_sound(motion.value->twist);
      break;
    }
    case 4: {
      const auto bytes = message_of<base_t>(input, fingerprint);
      if (const auto base = decode_base(bytes.data(), bytes.size(), {}); base.value) {
        require_sound(base.value->command);
        fuzz::require(base.value->monotonic_us >= 0, "the base's clock is a time");
      }
      break;
    }
    default: {
      const auto bytes = message_of<status_t>(input, fingerprint);
      if (const auto status = decode_status(bytes.data(), bytes.size()); status.value)
        fuzz::require(std::isfinite(status.value->setpoint.distance_m), "a status is finite");
    }
  }
  return 0;
}
