#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// The largest configuration, calibration, leader, controller or scenario that is read: some fifty times the largest
/// that exists, and still read by yaml-cpp (0.2 MB/s) in a second or two.
inline constexpr std::size_t kMaxTextBytes = std::size_t{256} * 1024;

/// A text, and where it came from: for messages, and because files it names are relative to it.
struct TextFile {
  std::filesystem::path path;  ///< where it was read
  std::string text;            ///< its content
  std::string key = "file";    ///< what named it: a dotted key or an option; for messages on the whole of it
};

/// Throws ConfigError unless the text is UTF-8: yaml-cpp reads some of what is not for ever.
void check_utf8(std::string_view text, const std::string& key, const std::filesystem::path& path);

/// The only way in which this module reads from disk: regular files of up to kMaxTextBytes, UTF-8. Throws ConfigError
/// with the key that named the file.
TextFile read_text_file(const std::filesystem::path& path, const std::string& key = "file");

}  // namespace pilotfish::config
PILOTFISH_API_END
