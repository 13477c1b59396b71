#include "v4l2_stream.hpp"

#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "buffer_age.hpp"
#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::capture {
namespace {

/// One is being read, one being filled, and two are spare for a reader that is late.
constexpr std::uint32_t kBuffers = 4;

/// Where buffers carry no stamp, the queue is looked at this often, so that their age is known this well.
constexpr std::int64_t kLookEveryUs = 5'000;

v4l2_buffer empty_buffer(std::uint32_t index = 0) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

[[noreturn]] void refuse(const V4l2Device& device, const std::string& what) {
  const int error = errno;
  std::string advice;
  if (error == EBUSY) advice = "; another program may be using it";
  if (error == ENOSPC)
    advice = "; its USB bus has no bandwidth left: use another port, a smaller picture, or fewer cameras";
  throw CaptureError("the camera " + device.path() + " " + what + ": " + std::strerror(error) + advice);
}

}  // namespace

V4l2Stream::V4l2Stream(V4l2Device device) : device_(std::move(device)) {
  try {
    map_buffers();
    for (std::uint32_t i = 0; i < mappings_.size(); ++i) {
      v4l2_buffer buffer = empty_buffer(i);
      if (!device_.ask(VIDIOC_QBUF, &buffer)) refuse(device_, "takes no buffers");
    }
    seen_empty_at_us_ = monotonic_now().us;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!device_.ask(VIDIOC_STREAMON, &type)) refuse(device_, "does not start");
  } catch (const CaptureError&) {
    unmap_buffers();
    throw;
  }
}

V4l2Stream::~V4l2Stream() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_.ask(VIDIOC_STREAMOFF, &type);
  unmap_buffers();
}

void V4l2Stream::map_buffers() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (!device_.ask(VIDIOC_REQBUFS, &request)) refuse(device_, "gives no buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = empty_buffer(i);
    if (!device_.ask(VIDIOC_QUERYBUF, &buffer)) refuse(device_, "does not describe its buffers");
    void* data = ::mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, device_.fd(), buffer.m.offset);
    if (data == MAP_FAILED) refuse(device_, "does not share its buffers");
    mappings_.push_back({static_cast<std::uint8_t*>(data), buffer.length});
    last_ = buffer;
  }
  if (mappings_.size() < 2) throw CaptureError("the camera " + device_.path() + " has fewer than two buffers");
}

void V4l2Stream::unmap_buffers() noexcept {
  for (const Mapping& mapping : mappings_) ::munmap(mapping.data, mapping.size_bytes);
  mappings_.clear();
}

const char* V4l2Stream::stamped() const {
  if (!has_monotonic_stamp(last_)) return "nothing";
  const bool exposure = (last_.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return exposure ? "the exposure" : "the end of a picture";
}

std::optional<FilledBuffer> V4l2Stream::newest(std::chrono::milliseconds timeout) {
  const std::int64_t deadline_us = monotonic_now().us + std::chrono::microseconds(timeout).count();
  std::optional<FilledBuffer> newest;
  do {
    newest = take_newest();
  } while (!newest && wait_until(deadline_us));
  return newest;
}

std::optional<FilledBuffer> V4l2Stream::take_newest() {
  const std::int64_t seen_empty_at_us = seen_empty_at_us_;
  std::optional<v4l2_buffer> newest;
  for (std::size_t taken = 0; taken < mappings_.size() && why_ended_.empty(); ++taken) {
    const std::int64_t looked_at_us = monotonic_now().us;
    const std::optional<v4l2_buffer> next = take_one();
    if (!next) {
      seen_empty_at_us_ = looked_at_us;
      break;
    }
    if (newest) give_back(newest->index);
    newest = next;
  }
  if (!newest || !why_ended_.empty()) return std::nullopt;
  last_ = *newest;
  const Mapping& mapping = mappings_[newest->index];
  const bool usable = (newest->flags & V4L2_BUF_FLAG_ERROR) == 0 && newest->bytesused <= mapping.size_bytes;
  return FilledBuffer{*newest, mapping.data, usable ? newest->bytesused : 0, seen_empty_at_us};
}

/// A finished buffer, if there is one.
std::optional<v4l2_buffer> V4l2Stream::take_one() {
  v4l2_buffer buffer = empty_buffer();
  if (!device_.ask(VIDIOC_DQBUF, &buffer)) {
    if (errno != EAGAIN) end("gives no more pictures", errno);
    return std::nullopt;
  }
  if (buffer.index < mappings_.size()) return buffer;
  end("gives a buffer that was not asked for", EPROTO);
  return std::nullopt;
}

/// Waits for the driver; false if nothing came before the deadline, or never will.
bool V4l2Stream::wait_until(std::int64_t deadline_us) {
  const std::int64_t left_us = deadline_us - monotonic_now().us;
  if (left_us <= 0) return false;
  const std::int64_t slice_us = has_monotonic_stamp(last_) ? left_us : std::min(left_us, kLookEveryUs);
  pollfd waiting{device_.fd(), POLLIN, 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>((slice_us + 999) / 1000));
  if (ready < 0 && errno != EINTR) end("cannot be waited for", errno);
  if (ready > 0 && (waiting.revents & POLLIN) == 0) {
    // Unplugged, or its stream stopped. Requesting a picture returns the reason; waiting again would return at once.
    if (const auto late = take_one())
      give_back(late->index);
    else if (why_ended_.empty())
      end("has stopped", EIO);
  }
  return why_ended_.empty();
}

void V4l2Stream::give_back(std::uint32_t index) {
  v4l2_buffer buffer = empty_buffer(index);
  if (!device_.ask(VIDIOC_QBUF, &buffer)) end("takes no more buffers", errno);
}

void V4l2Stream::end(const std::string& what, int error) {
  if (!why_ended_.empty()) return;
  why_ended_ = error == ENODEV ? "the camera " + device_.path() + " has been pulled out"
                               : "the camera " + device_.path() + " " + what + ": " + std::strerror(error);
}

}  // namespace pilotfish::capture
