#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pilotfish::capture {

/// A picture of a folder and the time that belongs to it.
struct ListedPicture {
  std::filesystem::path path;
  std::int64_t utime = 0;
};

/// Natural order of file names: runs of digits compare as numbers, so "2.png" comes before "10.png".
bool natural_less(const std::string& a, const std::string& b);

/// The pictures of a folder, as open_images() describes. Throws CaptureError naming the file (and line) that is wrong.
std::vector<ListedPicture> list_pictures(const std::filesystem::path& directory, double frame_rate_hz);

}  // namespace pilotfish::capture
