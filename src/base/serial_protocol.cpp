#include "pilotfish/base/serial_protocol.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace pilotfish::base {
namespace {

constexpr std::string_view kSetPoint = "PFW";
constexpr std::string_view kEncoders = "PFE";
constexpr char kHex[] = "0123456789ABCDEF";

std::int32_t milliradians(double radps) noexcept {
  if (!std::isfinite(radps)) return 0;
  const double most = kMaxWheel_mradps;
  return static_cast<std::int32_t>(std::lround(std::clamp(radps * 1e3, -most, most)));
}

std::optional<int> hex_digit(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

/// Fields between commas, each a whole number that fits.
class Fields {
 public:
  explicit Fields(std::string_view rest) : rest_(rest) {}
  std::optional<std::string_view> word() noexcept {
    if (ended_) return std::nullopt;
    const std::size_t comma = rest_.find(',');
    const std::string_view field = rest_.substr(0, comma);
    ended_ = comma == std::string_view::npos;
    if (!ended_) rest_.remove_prefix(comma + 1);
    return field;
  }
  template <class Number>
  bool number(Number& value) noexcept {
    const std::optional<std::string_view> field = word();
    if (!field) return false;
    const char* end = field->data() + field->size();
    const auto [stopped, error] = std::from_chars(field->data(), end, value);
    return error == std::errc() && stopped == end;
  }
  bool ended() const noexcept { return ended_; }

 private:
  std::string_view rest_;
  bool ended_ = false;
};

std::optional<ControllerLine> parse(std::string_view body) noexcept {
  Fields fields(body);
  if (fields.word() != kEncoders) return std::nullopt;
  ControllerLine line;
  EncoderReading& encoders = line.encoders;
  if (!fields.number(line.sequence) || !fields.number(encoders.time_ms) || !fields.number(encoders.left_ticks) ||
      !fields.number(encoders.right_ticks) || !fields.number(line.faults) || !fields.ended())
    return std::nullopt;
  return line;
}

}  // namespace

/// Bit by bit: x^8 + x^2 + x + 1 divides the text times x^8. Finds every error within 8 bits next to each other.
std::uint8_t crc8(std::string_view text) noexcept {
  unsigned remainder = 0;
  for (const char c : text) {
    remainder ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder << 1) ^ ((remainder & 0x80U) != 0 ? 0x107U : 0U);
  }
  return static_cast<std::uint8_t>(remainder);
}

SetPointLine::SetPointLine(std::uint16_t sequence, const WheelSpeeds& speeds) noexcept {
  const auto put = [this](std::string_view part) {
    for (const char c : part)
      if (size_ < text_.size()) text_[size_++] = c;
  };
  const auto put_number = [&](std::int32_t number) {
    std::array<char, 12> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    put(",");
    put({digits.data(), static_cast<std::size_t>(end - digits.data())});
  };
  put("$");
  put(kSetPoint);
  put_number(sequence);
  put_number(milliradians(speeds.left_radps));
  put_number(milliradians(speeds.right_radps));
  const std::uint8_t sum = crc8(text().substr(1));
  const std::array<char, 5> end{'*', kHex[sum >> 4U], kHex[sum & 15U], '\r', '\n'};
  put({end.data(), end.size()});
}

std::string_view first_fault(std::uint16_t faults) noexcept {
  if ((faults & kFaultEmergencyStop) != 0) return "the emergency stop is pressed";
  if ((faults & kFaultMotor) != 0) return "a motor driver reports an error";
  if ((faults & kFaultOvercurrent) != 0) return "a motor draws too much current";
  if ((faults & kFaultEncoder) != 0) return "an encoder does not count";
  if ((faults & kFaultSupply) != 0) return "the supply is too low";
  return faults == 0 ? "" : "a fault without a name";
}

void ControllerParser::reset() noexcept {
  inside_ = false;
  size_ = 0;
}

std::optional<ControllerLine> ControllerParser::feed(char byte) noexcept {
  if (byte == '$') {
    if (inside_) ++rejected_.cut_short;
    inside_ = true;
    size_ = 0;
    return std::nullopt;
  }
  if (!inside_) return std::nullopt;  // between lines: a boot loader's chatter, the \n behind a \r
  if (byte == '\r' || byte == '\n') return complete();
  if (size_ + 1 == kMaxLine) {  // and the $
    ++rejected_.too_long;
    reset();
    return std::nullopt;
  }
  line_[size_++] = byte;
  return std::nullopt;
}

std::optional<ControllerLine> ControllerParser::complete() noexcept {
  const std::string_view line(line_.data(), size_);
  reset();
  constexpr std::size_t kChecksum = 3;  // *HH
  const auto high = line.size() < kChecksum ? std::nullopt : hex_digit(line[line.size() - 2]);
  const auto low = line.size() < kChecksum ? std::nullopt : hex_digit(line[line.size() - 1]);
  if (!high || !low || line[line.size() - kChecksum] != '*' ||
      crc8(line.substr(0, line.size() - kChecksum)) != *high * 16 + *low) {
    ++rejected_.checksum;
    return std::nullopt;
  }
  std::optional<ControllerLine> parsed = parse(line.substr(0, line.size() - kChecksum));
  if (!parsed) ++rejected_.malformed;
  return parsed;
}

}  // namespace pilotfish::base
