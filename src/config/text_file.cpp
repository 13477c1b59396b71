#include "pilotfish/config/text_file.hpp"

#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/read_file.hpp"

namespace pilotfish::config {
namespace {

/// Where the text stops being UTF-8, or its size. Lead bytes say how many 10xxxxxx follow; the shortest form only, no
/// surrogates, nothing above U+10FFFF (RFC 3629, section 4).
std::size_t utf8_until(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const auto byte = [&](std::size_t i) {
      return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0U;
    };
    const unsigned lead = byte(0), second = byte(1);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    const bool not_shortest = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
    const bool no_letter = (lead == 0xED && second > 0x9F) || (lead == 0xF4 && second > 0x8F);
    if (length == 0 || not_shortest || no_letter) return at;
    for (std::size_t i = 1; i < length; ++i)
      if ((byte(i) & 0xC0U) != 0x80U) return at;
    at += length;
  }
  return at;
}

}  // namespace

void check_utf8(std::string_view text, const std::string& key, const std::filesystem::path& path) {
  const std::size_t until = utf8_until(text);
  if (until == text.size()) return;
  throw ConfigError(key, path.string() + " is not a text in UTF-8: byte " + std::to_string(until) + " is none");
}

TextFile read_text_file(const std::filesystem::path& path, const std::string& key) {
  FileRead read = read_file(path, kMaxTextBytes);
  if (!read.bytes) throw ConfigError(key, read.problem);
  check_utf8(*read.bytes, key, path);
  return {path, std::move(*read.bytes), key};
}

}  // namespace pilotfish::config
