#pragma once

#include <charconv>
#include <optional>
#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The whole text as a decimal number, whatever the locale says; nothing if anything else stands there ("640abc", "",
/// "0x10") or if it is beyond what Value can hold. A plus may stand in front; for double, inf and nan pass.
template <class Value>
std::optional<Value> number_from(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars knows no plus
  Value value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace pilotfish
PILOTFISH_API_END
