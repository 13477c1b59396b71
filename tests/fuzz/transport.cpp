// Datagrams of four senders, at any time and in any order. A record of the input:
//   u8   1: a fragment is made of the numbers below; 0: the bytes go in as they are; 2 bits sender; 5 bits time step
//   made: u8 sequence, u16 message bytes, u16 offset, u8 number, u8 fragments
//   u8   how many bytes (times 4 for those as they are), bytes
#include <array>
#include <utility>
#include <vector>

#include "fuzz_input.hpp"
#include "reassembly.hpp"

using namespace pilotfish;
using namespace pilotfish::bus;

namespace {

std::uint8_t* put(std::uint8_t* at, std::uint32_t value, int size_bytes) {
  for (int i = size_bytes - 1; i >= 0; --i) *at++ = static_cast<std::uint8_t>(value >> 8 * i);
  return at;
}

/// In memory of exactly its size, so that the sanitizer sees a step behind its end.
std::vector<std::uint8_t> next_datagram(fuzz::FuzzInput& input, bool made) {
  std::array<std::uint8_t, 20> header{};
  if (made) {
    std::uint8_t* at = put(header.data(), 0x4c433033, 4);
    for (const auto& [taken_bytes, wire_bytes] : {std::pair{1, 4}, {2, 4}, {2, 4}, {1, 2}, {1, 2}})
      at = put(at, input.number(static_cast<std::size_t>(taken_bytes)), wire_bytes);
  }
  const std::size_t header_bytes = made ? header.size() : 0;
  std::size_t taken = 0;
  const std::uint8_t* bytes = input.bytes(input.number(1) * (made ? 1 : 4), taken);
  std::vector<std::uint8_t> datagram(header_bytes + taken);
  std::copy_n(header.begin(), header_bytes, datagram.begin());
  std::copy_n(bytes, taken, datagram.begin() + static_cast<std::ptrdiff_t>(header_bytes));
  return datagram;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ReassemblyLimits limits;
  limits.max_message_bytes = 20'000;
  limits.max_held_bytes = 30'000;
  limits.max_messages = 6;
  limits.max_messages_per_sender = 3;
  limits.patience_us = 100;
  std::int64_t refused = 0;
  Reassembly reassembly(
      [&](std::string_view kind, std::int64_t times) {
        fuzz::require(kind.size() <= 24 && times == 1, "a refusal has a short name");
        refused += times;
      },
      limits);
  reassembly.subscribe("A");
  reassembly.subscribe("IMAGE");

  fuzz::FuzzInput input(data, size);
  std::int64_t now_us = 0;
  for (int datagrams = 0; !input.empty() && datagrams < 400; ++datagrams) {
    const std::uint32_t control = input.number(1);
    now_us += control & 31;
    const Sender sender{0x7f000001, static_cast<std::uint16_t>(control >> 5 & 3)};
    const std::vector<std::uint8_t> datagram = next_datagram(input, (control & 128) != 0);
    const auto message = reassembly.take(datagram.data(), datagram.size(), sender, {now_us});
    fuzz::require(reassembly.held_bytes() <= limits.max_held_bytes, "memory is bounded");
    fuzz::require(reassembly.unfinished() <= limits.max_messages, "unfinished messages are few");
    fuzz::require(refused <= 10 * (datagrams + 1), "one datagram makes few refusals");
    if (!message) continue;
    fuzz::require(message->channel == "A" || message->channel == "IMAGE", "nobody else's channel comes through");
    fuzz::require(message->payload->size() <= limits.max_message_bytes, "a message is not too large");
    fuzz::require(message->arrival.us <= now_us, "a message does not come from the future");
  }
  return 0;
}
