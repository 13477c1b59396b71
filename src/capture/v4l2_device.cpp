#include "v4l2_device.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "picture_list.hpp"
#include "pilotfish/capture/frame_source.hpp"

namespace pilotfish::capture {
namespace {

std::string why_not_opened(const std::string& path, int error) {
  if (error == ENOENT || error == ENODEV || error == ENXIO) return "there is no camera " + path;
  if (error == EACCES || error == EPERM)
    return "cannot use the camera " + path + ": " + std::strerror(error) +
           "; add yourself to the group 'video' (sudo usermod -aG video $USER) and log in again";
  if (error == EBUSY) return "the camera " + path + " is in use by another program";
  return "the camera " + path + " cannot be opened: " + std::strerror(error);
}

/// Why the device is not a source of pictures; nothing if it is one.
std::string why_no_camera(const V4l2Device& device) {
  v4l2_capability capability{};
  if (!device.ask(VIDIOC_QUERYCAP, &capability)) return "is no Video4Linux device";
  // A driver with several devices says in device_caps what this one can do.
  const bool each = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const auto can = each ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0)
    return "gives its pictures in several planes, which is not supported; offer it through v4l2loopback";
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0)
    return "gives no pictures (many cameras have a second device for metadata); try another number";
  if ((can & V4L2_CAP_STREAMING) == 0) return "cannot stream";
  return {};
}

}  // namespace

std::string cameras_present() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error))
    if (entry.path().filename().string().rfind("video", 0) == 0) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end(), natural_less);
  std::string text;
  for (const std::string& name : names) text += " " + name;
  return "; cameras here:" + (text.empty() ? " none" : text);
}

V4l2Device::V4l2Device(int index)
    : path_("/dev/video" + std::to_string(index)), fd_(::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
  if (fd_ < 0) throw CaptureError(why_not_opened(path_, errno) + cameras_present());
  const std::string problem = why_no_camera(*this);
  if (problem.empty()) return;
  ::close(fd_);
  throw CaptureError("the camera " + path_ + " " + problem + cameras_present());
}

V4l2Device::V4l2Device(V4l2Device&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}

V4l2Device::~V4l2Device() {
  if (fd_ >= 0) ::close(fd_);
}

bool V4l2Device::ask(unsigned long request, void* argument) const {
  while (::ioctl(fd_, request, argument) != 0)
    if (errno != EINTR) return false;
  return true;
}

}  // namespace pilotfish::capture
