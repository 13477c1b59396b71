#pragma once

#include <string>

namespace pilotfish::capture {

/// An open /dev/videoN.
class V4l2Device {
 public:
  /// Throws CaptureError with what is wrong with the device, and the remedy.
  explicit V4l2Device(int index);
  V4l2Device(V4l2Device&& other) noexcept;
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;
  V4l2Device& operator=(V4l2Device&&) = delete;
  ~V4l2Device();

  int fd() const { return fd_; }
  const std::string& path() const { return path_; }
  /// ioctl() that a signal cannot interrupt; true if it succeeded, else errno says why not.
  bool ask(unsigned long request, void* argument) const;

 private:
  std::string path_;
  int fd_ = -1;
};

/// "; cameras here: /dev/video0 /dev/video2", or "; cameras here: none".
std::string cameras_present();

}  // namespace pilotfish::capture
