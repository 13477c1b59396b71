#include "picture_list.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <sstream>
#include <string_view>

#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/core/number.hpp"
#include "pilotfish/core/read_file.hpp"

namespace pilotfish::capture {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListName = "frames.csv";
constexpr std::size_t kMaxListBytes = std::size_t{64} << 20;  // half a million pictures, five hours

/// No double beyond fits into an int64.
constexpr double kMaxUtime_us = 9.2e18;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes the run of digits at the front of `text`, without leading zeros.
std::string_view take_number(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

bool is_picture(const fs::directory_entry& entry) {
  std::string suffix = entry.path().extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::error_code error;  // a link in a circle is no picture, and no reason to give up either
  return entry.is_regular_file(error) && entry.path().filename().string().front() != '.' &&
         std::find(kPictureSuffixes.begin(), kPictureSuffixes.end(), suffix) != kPictureSuffixes.end();
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view field = line.substr(0, comma);
    while (!field.empty() && std::isspace(static_cast<unsigned char>(field.front()))) field.remove_prefix(1);
    while (!field.empty() && std::isspace(static_cast<unsigned char>(field.back()))) field.remove_suffix(1);
    fields.push_back(field);
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::vector<ListedPicture> read_list(const fs::path& directory) {
  const fs::path list = directory / kListName;
  const FileRead read = read_file(list, kMaxListBytes);
  if (!read.bytes) throw CaptureError(read.problem);
  std::istringstream stream(*read.bytes);
  std::string line;
  int line_number = 1;
  const auto fail = [&](const std::string& problem) {
    throw CaptureError(list.string() + ", line " + std::to_string(line_number) + ": " + problem);
  };
  if (!std::getline(stream, line)) fail("is empty");
  const auto names = split(line);
  const auto column = [&](std::string_view name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) fail("there is no column '" + std::string(name) + "' (needed: file,utime_us)");
    return static_cast<std::size_t>(found - names.begin());
  };
  const std::size_t file_column = column("file"), utime_column = column("utime_us");

  std::vector<ListedPicture> pictures;
  while (std::getline(stream, line)) {
    ++line_number;
    const auto fields = split(line);
    if (fields.size() == 1 && fields[0].empty()) continue;
    if (fields.size() != names.size())
      fail("there are " + std::to_string(fields.size()) + " fields, the header has " + std::to_string(names.size()));
    const auto utime = number_from<std::int64_t>(fields[utime_column]);
    if (!utime) fail("'" + std::string(fields[utime_column]) + "' is not a whole number of microseconds");
    ListedPicture picture{directory / fields[file_column], *utime};
    std::error_code error;
    if (!fs::is_regular_file(picture.path, error)) fail("there is no file " + picture.path.string());
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

std::vector<ListedPicture> in_natural_order(const fs::path& directory, double frame_rate_hz) {
  std::vector<ListedPicture> pictures;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error))
    if (is_picture(*entry)) pictures.push_back({entry->path(), 0});
  if (error) throw CaptureError("cannot read the folder " + directory.string() + ": " + error.message());
  std::sort(pictures.begin(), pictures.end(), [](const ListedPicture& a, const ListedPicture& b) {
    return natural_less(a.path.filename().string(), b.path.filename().string());
  });
  if ((static_cast<double>(pictures.size()) - 1.0) * 1e6 / frame_rate_hz >= kMaxUtime_us)
    throw CaptureError("the frame rate " + std::to_string(frame_rate_hz) + " Hz is too low to give pictures a time");
  // From the start each time, so that the rounding to microseconds does not add up.
  for (std::size_t i = 0; i < pictures.size(); ++i)
    pictures[i].utime = std::llround(static_cast<double>(i) * 1e6 / frame_rate_hz);
  return pictures;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  std::string_view left = a, right = b;
  while (!left.empty() && !right.empty()) {
    if (is_digit(left.front()) && is_digit(right.front())) {
      const std::string_view x = take_number(left), y = take_number(right);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else if (left.front() != right.front()) {
      return left.front() < right.front();
    } else {
      left.remove_prefix(1);
      right.remove_prefix(1);
    }
  }
  if (left.size() != right.size()) return left.size() < right.size();
  return a < b;  // equal up to leading zeros
}

std::vector<ListedPicture> list_pictures(const fs::path& directory, double frame_rate_hz) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) throw CaptureError("there is no folder " + directory.string());
  const bool listed = fs::exists(fs::symlink_status(directory / kListName, error));
  if (!listed && !(std::isfinite(frame_rate_hz) && frame_rate_hz > 0.0))
    throw CaptureError("the frame rate of pictures must be positive, it is " + std::to_string(frame_rate_hz) + " Hz");
  std::vector<ListedPicture> pictures = listed ? read_list(directory) : in_natural_order(directory, frame_rate_hz);
  if (pictures.empty())
    throw CaptureError("there are no pictures in " + directory.string() + " (png, jpg, pgm, ppm, bmp, tif, webp)");
  return pictures;
}

}  // namespace pilotfish::capture
