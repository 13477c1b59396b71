#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The content of a file, or why it was not read and what is expected instead.
struct FileRead {
  std::optional<std::string> bytes;  ///< nothing if it was not read
  std::string problem;               ///< empty if there are bytes
};

/// Reads regular files (and links to them) of up to max_bytes, and nothing else: a directory has no content, a pipe, a
/// socket or a terminal may never give any, and a device such as /dev/zero never ends. Neither blocks nor throws
/// anything but std::bad_alloc.
FileRead read_file(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace pilotfish
PILOTFISH_API_END
