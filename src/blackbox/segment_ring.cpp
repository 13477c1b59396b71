#include "segment_ring.hpp"

#include <endian.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <regex>
#include <system_error>
#include <tuple>
#include <utility>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::blackbox {
namespace {

constexpr const char* kKey = "black_box.directory";
constexpr mode_t kMode = 0640;
/// Alone on a full disk, a file of this part of its size is given up for what is newer.
constexpr std::int64_t kWorthGivingUp = 2;

ConfigError unusable(const std::filesystem::path& path, int problem) {
  return {kKey, "cannot write in " + path.string() + ": " + std::strerror(problem)};
}

/// When a file was last written, wall clock; 0, older than any age, if it does not say.
std::int64_t modified_utime(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return 0;
  return status.st_mtim.tv_sec * 1'000'000LL + status.st_mtim.tv_nsec / 1000;
}

/// lcm-logger's: sync word, number, time, length of the channel, length of the data; big endian.
struct Header {
  std::array<std::uint8_t, 28> bytes{};
  Header(std::int64_t number, const Event& event) {
    put<std::uint32_t>(0, htobe32(0xEDA1DA01));
    put<std::uint64_t>(4, htobe64(static_cast<std::uint64_t>(number)));
    put<std::uint64_t>(12, htobe64(static_cast<std::uint64_t>(event.utime)));
    put<std::uint32_t>(20, htobe32(static_cast<std::uint32_t>(event.channel.size())));
    put<std::uint32_t>(24, htobe32(static_cast<std::uint32_t>(event.data.size())));
  }
  template <class Number>
  void put(std::size_t at, Number number) {
    std::memcpy(bytes.data() + at, &number, sizeof number);
  }
};

}  // namespace

SegmentRing::SegmentRing(std::filesystem::path directory, std::string name, std::int64_t utime,
                         const RingLimits& limits)
    : directory_(std::move(directory)), name_(std::move(name)), limits_(limits) {
  std::error_code problem;
  std::filesystem::create_directories(directory_, problem);
  if (problem) throw unusable(directory_, problem.value());
  lock_directory();
  find_older(utime);
}

SegmentRing::~SegmentRing() {
  close_segment();
  if (lock_ >= 0) close(lock_);
}

/// Held by the process, so that the kernel releases it however this ends.
void SegmentRing::lock_directory() {
  const std::filesystem::path path = directory_ / ("." + name_ + ".lock");
  lock_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kMode);
  if (lock_ < 0) throw unusable(directory_, errno);
  if (flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  const int problem = errno;
  close(lock_);
  if (problem != EWOULDBLOCK) throw unusable(directory_, problem);
  throw ConfigError(kKey, "another program records " + name_ + " in " + directory_.string());
}

void SegmentRing::find_older(std::int64_t utime) {
  const std::regex pattern(name_ + R"(-(\d{1,18})-(\d{1,9})\.lcmlog)");
  std::vector<Segment> found;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(directory_, problem)) {
    const std::string file = entry.path().filename().string();
    std::smatch match;
    std::error_code ignored;
    if (!std::regex_match(file, match, pattern) || !entry.is_regular_file(ignored)) continue;
    const auto size = static_cast<std::int64_t>(entry.file_size(ignored));
    found.push_back(
        {entry.path(), std::stoll(match[1]), std::stoll(match[2]), ignored ? 0 : size, modified_utime(entry.path())});
  }
  if (problem) throw unusable(directory_, problem.value());
  std::sort(found.begin(), found.end(), [](const Segment& a, const Segment& b) {
    return std::tie(a.start, a.number) < std::tie(b.start, b.number);
  });
  start_ = found.empty() ? utime : std::max(utime, found.back().start + 1);
  for (Segment& segment : found) {
    older_bytes_ += segment.bytes;
    older_.push_back(std::move(segment));
  }
}

bool SegmentRing::open_segment() {
  current_ = {directory_ / (name_ + "-" + std::to_string(start_) + "-" + std::to_string(next_) + ".lcmlog"), start_,
              next_, 0, 0};
  // Not truncated: should there be such a file after all, what it holds stays.
  file_ = open(current_.path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, kMode);
  if (file_ < 0) return false;
  struct stat status {};
  bytes_ = fstat(file_, &status) == 0 ? status.st_size : 0;
  ++next_;
  return true;
}

void SegmentRing::close_segment() {
  if (file_ < 0) return;
  close(file_);
  file_ = -1;
  if (bytes_ == 0) {
    unlink(current_.path.c_str());
    return;
  }
  current_.bytes = bytes_;
  older_bytes_ += bytes_;
  older_.push_back(std::exchange(current_, {}));
  bytes_ = 0;
}

bool SegmentRing::delete_oldest() {
  if (older_.empty()) return false;
  unlink(older_.front().path.c_str());  // if it cannot be deleted, do not retry for ever
  older_bytes_ -= older_.front().bytes;
  older_.pop_front();
  return true;
}

void SegmentRing::delete_aged(std::int64_t utime) {
  if (limits_.max_age_us == 0) return;
  while (!older_.empty() && utime - older_.front().newest_utime > limits_.max_age_us) delete_oldest();
}

bool SegmentRing::make_room_on_full_disk() {
  if (errno != ENOSPC && errno != EDQUOT) return false;
  if (older_.empty() && bytes_ >= limits_.segment_bytes / kWorthGivingUp) close_segment();
  return delete_oldest();
}

bool SegmentRing::write(const Event& event) {
  const Header header(events_, event);
  buffer_.assign(header.bytes.begin(), header.bytes.end());
  buffer_.insert(buffer_.end(), event.channel.begin(), event.channel.end());
  buffer_.insert(buffer_.end(), event.data.begin(), event.data.end());
  const auto bytes = static_cast<std::int64_t>(buffer_.size());
  if (bytes > limits_.total_bytes) return errno = EFBIG, false;
  // The caller has not begun a new file; the limit applies nevertheless.
  if (file_ >= 0 && bytes_ > 0 && bytes_ + bytes > limits_.total_bytes / 2) close_segment();
  delete_aged(event.utime);
  while (older_bytes_ + bytes_ + bytes > limits_.total_bytes && delete_oldest()) {
  }
  do {
    if ((file_ >= 0 || open_segment()) && append()) {
      ++events_;
      current_.newest_utime = event.utime;
      return true;
    }
  } while (make_room_on_full_disk());
  const int problem = errno;
  // Too long a file, or a disk with an error: the next file may succeed.
  if (problem != ENOSPC && problem != EDQUOT) close_segment();
  errno = problem;
  return false;
}

/// All of the buffer or nothing: what a full disk has taken of an event is cut off again. (What cannot be cut, a pipe,
/// keeps half an event, and readers look for the next one.)
bool SegmentRing::append() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t written = ::write(file_, buffer_.data() + done, buffer_.size() - done);
    if (written >= 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      const int problem = errno;
      if (done > 0 && ftruncate(file_, bytes_) != 0) bytes_ += static_cast<std::int64_t>(done);
      errno = problem;
      return false;
    }
  }
  bytes_ += static_cast<std::int64_t>(done);
  return true;
}

void SegmentRing::sync() {
  if (file_ >= 0) fdatasync(file_);
}

}  // namespace pilotfish::blackbox
