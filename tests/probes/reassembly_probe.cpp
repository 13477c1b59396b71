// Feeds bus::Reassembly from lines on stdin and prints what comes out, so that tests decide every byte and every time:
//   limits MAX_MESSAGE_BYTES MAX_HELD_BYTES MAX_MESSAGES MAX_PER_SENDER PATIENCE_US      (first, optional)
//   subscribe CHANNEL
//   datagram ADDRESS PORT ARRIVAL_US HEX         -> message CHANNEL ARRIVAL_US HEX, when it completes one
//   held                                         -> held BYTES UNFINISHED_MESSAGES
//   arrival STAMP EMPTY_MONOTONIC EMPTY_WALL NOW_MONOTONIC NOW_WALL [us]                 -> arrival US
// and at the end  count NAME TIMES  for everything refused.
#include <iostream>
#include <map>
#include <sstream>
#include <string>

#include "arrival.hpp"
#include "reassembly.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::bus;

std::vector<std::uint8_t> from_hex(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

std::string to_hex(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : bytes) hex.append({kDigits[byte >> 4], kDigits[byte & 15]});
  return hex;
}

}  // namespace

int main() {
  std::map<std::string, std::int64_t> counts;
  const Count count = [&](std::string_view kind, std::int64_t times) { counts[std::string(kind)] += times; };
  ReassemblyLimits limits;
  std::optional<Reassembly> reassembly(std::in_place, count, limits);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string what, text;
    words >> what;
    if (what == "limits") {
      words >> limits.max_message_bytes >> limits.max_held_bytes >> limits.max_messages >>
          limits.max_messages_per_sender >> limits.patience_us;
      reassembly.emplace(count, limits);
    } else if (what == "subscribe") {
      words >> text;
      reassembly->subscribe(text);
    } else if (what == "held") {
      std::cout << "held " << reassembly->held_bytes() << ' ' << reassembly->unfinished() << '\n';
    } else if (what == "arrival") {
      std::int64_t stamp_us = 0;
      Clocks empty, now;
      words >> stamp_us >> empty.monotonic.us >> empty.wall_us >> now.monotonic.us >> now.wall_us;
      std::cout << "arrival " << arrival_of(stamp_us, empty, now).us << '\n';
    } else {
      Sender sender;
      MonotonicTime arrival;
      words >> sender.address >> sender.port >> arrival.us >> text;
      const std::vector<std::uint8_t> datagram = from_hex(text);
      const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[datagram.size()]);  // a sanitizer watches its end
      std::copy(datagram.begin(), datagram.end(), exact.get());
      if (const auto message = reassembly->take(exact.get(), datagram.size(), sender, arrival))
        std::cout << "message " << message->channel << ' ' << message->arrival.us << ' ' << to_hex(*message->payload)
                  << '\n';
    }
  }
  for (const auto& [name, times] : counts) std::cout << "count " << name << ' ' << times << '\n';
}
