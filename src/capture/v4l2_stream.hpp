#pragma once

#include <linux/videodev2.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "v4l2_device.hpp"

namespace pilotfish::capture {

/// A picture in the driver's memory, until it is given back.
struct FilledBuffer {
  v4l2_buffer buffer{};
  const std::uint8_t* data = nullptr;
  std::size_t size_bytes = 0;  ///< 0 if the driver marked it as damaged, or claims more than there is
  /// Boottime at which no picture was waiting yet.
  std::int64_t queue_seen_empty_at_us = 0;
};

/// The buffers that the driver fills, one after the other, from the constructor on.
class V4l2Stream {
 public:
  /// Throws CaptureError if the driver cannot stream.
  explicit V4l2Stream(V4l2Device device);
  V4l2Stream(const V4l2Stream&) = delete;
  V4l2Stream& operator=(const V4l2Stream&) = delete;
  ~V4l2Stream();

  /// The newest picture; those that it overtook go back to the driver unread. Nothing: none came in time, or the
  /// stream has ended.
  std::optional<FilledBuffer> newest(std::chrono::milliseconds timeout);
  /// Lets the driver fill the buffer again.
  void give_back(const FilledBuffer& filled) { give_back(filled.buffer.index); }

  /// What the driver's stamps refer to, by its flags: "the exposure", "the end of a picture" or "nothing".
  const char* stamped() const;
  /// Why there will be no more pictures; empty while there may be.
  const std::string& why_ended() const { return why_ended_; }
  const V4l2Device& device() const { return device_; }

 private:
  struct Mapping {
    std::uint8_t* data;
    std::size_t size_bytes;
  };

  void map_buffers();
  void unmap_buffers() noexcept;
  std::optional<FilledBuffer> take_newest();
  std::optional<v4l2_buffer> take_one();
  bool wait_until(std::int64_t deadline_us);
  void give_back(std::uint32_t index);
  void end(const std::string& what, int error);

  V4l2Device device_;
  std::vector<Mapping> mappings_;
  std::string why_ended_;
  std::int64_t seen_empty_at_us_ = 0;
  v4l2_buffer last_{};  ///< or the first as it was described; its flags show what stamps to expect
};

}  // namespace pilotfish::capture
