#pragma once

#include <cstdint>

// What tests/fake_camera.py writes into the file PILOTFISH_FAKE_CAMERA and the fake reads at every call, so that faults
// can be switched while a program runs. All fields are 64-bit, in this order; the Python side lists the same names.
namespace fake_camera {

constexpr int kFormats = 8;
constexpr int kPictures = 256;

struct Format {
  std::int64_t fourcc, width, height, rate_hz;
};

struct Picture {
  std::int64_t offset, size_bytes;  // in the file
};

struct Control {
  std::int64_t number;   // of /dev/videoN
  std::int64_t rate_hz;  // pictures per second
  std::int64_t buffer_bytes;
  // --- what goes wrong ---
  std::int64_t pulled_out;      // open() ENOENT, everything else ENODEV
  std::int64_t blocked;         // no buffer is ever filled
  std::int64_t late_us;         // from the exposure until the buffer can be had
  std::int64_t stamp_shift_us;  // added to stamps alone
  std::int64_t stamp_kind;      // 0: of the exposure; 1: none; 2: copied from elsewhere; 3: of the end of the picture
  std::int64_t error_flag;      // V4L2_BUF_FLAG_ERROR on every buffer
  std::int64_t bytes_short;     // taken off bytesused
  std::int64_t open_errno;
  std::int64_t stream_errno;
  std::int64_t granted_width;  // instead of the one asked for, if not 0
  std::int64_t slept_us;       // added to CLOCK_BOOTTIME
  // --- which pictures ---
  std::int64_t first_picture, picture_count;  // shown over and over, in turn
  // --- what the program did ---
  std::int64_t opens, closes, streaming, filled, dropped, taken;
  std::int64_t format_count;
  Format formats[kFormats];
  Picture pictures[kPictures];
};

}  // namespace fake_camera
