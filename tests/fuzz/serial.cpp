// What a motor controller, or noise, says on the line. The first byte: odd, the rest is what comes in; even, every line
// of it is framed with the checksum it should have, which a fuzzer would seldom guess.
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "fuzz_input.hpp"
#include "pilotfish/base/serial_protocol.hpp"

using namespace pilotfish::base;

namespace {

std::string framed(std::string_view text) {
  std::string all;
  while (!text.empty()) {
    const std::string_view body = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(body.size() + 1, text.size()));
    char end[8];
    std::snprintf(end, sizeof end, "*%02X\r\n", crc8(body));
    all += '$';
    all += body;
    all += end;
  }
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 2 == 0) text = framed(text);
  ControllerParser parser;
  std::int64_t taken = 0;
  for (const char byte : text) {
    const auto line = parser.feed(byte);
    if (!line) continue;
    ++taken;
    // What is taken stands in the input, its number perhaps behind leading zeros.
    pilotfish::fuzz::require(text.find("$PFE,") != std::string::npos, "a line without its type is taken");
    pilotfish::fuzz::require(text.find(std::to_string(line->sequence) + ",") != std::string::npos,
                             "a number is taken that was not sent");
  }
  const ControllerParser::Rejected& rejected = parser.rejected();
  const std::int64_t lines = taken + rejected.checksum + rejected.malformed + rejected.too_long + rejected.cut_short;
  pilotfish::fuzz::require(lines <= static_cast<std::int64_t>(text.size()), "more lines than bytes");
  return 0;
}
