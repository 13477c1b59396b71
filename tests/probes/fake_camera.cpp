// A Video4Linux camera that exists only for the program it is loaded into (LD_PRELOAD): open, ioctl, poll, close, stat
// and access of /dev/videoN are answered here, as the kernel would, with pictures and faults from a shared file
// (fake_camera.hpp). Its file descriptor is a memfd that holds the buffers, so mmap needs no fake.
#include "fake_camera.hpp"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <mutex>

namespace {

using fake_camera::Control;

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::int64_t clock_us(clockid_t clock) {
  static const auto get = real<int (*)(clockid_t, timespec*)>("clock_gettime");
  timespec now{};
  get(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1'000;
}

/// The shared file; null where no camera is faked.
volatile Control* control() {
  static volatile Control* const shared = []() -> volatile Control* {
    const char* path = getenv("PILOTFISH_FAKE_CAMERA");
    if (!path) return nullptr;
    const int fd = real<int (*)(const char*, int, ...)>("open")(path, O_RDWR | O_CLOEXEC);
    struct stat about {};
    if (fd < 0 || fstat(fd, &about) != 0) return nullptr;
    void* data = mmap(nullptr, static_cast<size_t>(about.st_size), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    return data == MAP_FAILED ? nullptr : static_cast<volatile Control*>(data);
  }
  ();
  return shared;
}

struct Done {
  std::uint32_t index, bytes_used;
  std::int64_t exposed_us, deliver_at_us;
  std::uint32_t sequence;
};

/// The driver's side of one open device. Pictures are taken at start + k / rate; each goes into the oldest buffer that
/// was queued at that moment, or is lost if there is none, as in a real driver.
struct Device {
  int fd = -1;
  v4l2_format format{};
  int buffers = 0;
  std::deque<std::uint32_t> queued;
  std::deque<Done> done;
  std::int64_t next_exposure_us = 0;
  std::uint32_t sequence = 0;
  bool streaming = false;
};

Device device;
std::mutex device_mutex;

size_t page_rounded(std::int64_t bytes) { return (static_cast<size_t>(bytes) + 4095) / 4096 * 4096; }

void fill(volatile Control& c, std::uint32_t index, std::int64_t exposed_us) {
  const std::int64_t which =
      c.first_picture + device.sequence % std::max(std::int64_t{1}, std::int64_t{c.picture_count});
  const volatile fake_camera::Picture& picture = c.pictures[which];
  const auto* bytes = const_cast<const char*>(reinterpret_cast<volatile char*>(&c)) + picture.offset;
  const auto size = static_cast<size_t>(std::min(std::int64_t{picture.size_bytes}, std::int64_t{c.buffer_bytes}));
  const ssize_t written = pwrite(device.fd, bytes, size, static_cast<off_t>(index * page_rounded(c.buffer_bytes)));
  const auto used = static_cast<std::uint32_t>(written - c.bytes_short);  // negative bytes_short: claims too many
  device.done.push_back({index, used, exposed_us, exposed_us + c.late_us, device.sequence});
  c.filled = c.filled + 1;
}

/// Takes every picture that was due until now.
void advance(volatile Control& c, std::int64_t now_us) {
  const std::int64_t period_us = 1'000'000 / c.rate_hz;
  for (; device.streaming && device.next_exposure_us <= now_us; device.next_exposure_us += period_us) {
    ++device.sequence;
    if (c.blocked) continue;
    if (device.queued.empty()) {
      c.dropped = c.dropped + 1;
      continue;
    }
    fill(c, device.queued.front(), device.next_exposure_us);
    device.queued.pop_front();
  }
}

bool something_to_take(std::int64_t now_us) {
  return !device.done.empty() && device.done.front().deliver_at_us <= now_us;
}

int fail(int error) {
  errno = error;
  return -1;
}

/// The format in the table with this fourcc and size; null if there is none.
const volatile fake_camera::Format* offered(volatile Control& c, std::int64_t fourcc, std::int64_t width,
                                            std::int64_t height) {
  for (int i = 0; i < c.format_count; ++i) {
    const volatile fake_camera::Format& f = c.formats[i];
    if (f.fourcc == fourcc && (width == 0 || (f.width == width && f.height == height))) return &f;
  }
  return nullptr;
}

int set_format(volatile Control& c, v4l2_format& format, bool keep) {
  v4l2_pix_format& pix = format.fmt.pix;
  const volatile fake_camera::Format* granted = offered(c, pix.pixelformat, pix.width, pix.height);
  if (!granted) granted = offered(c, pix.pixelformat, 0, 0);  // another size of this format, as drivers do
  if (!granted) granted = &c.formats[0];                      // or another format
  pix.pixelformat = static_cast<std::uint32_t>(granted->fourcc);
  pix.width = static_cast<std::uint32_t>(keep && c.granted_width ? c.granted_width : granted->width);
  pix.height = static_cast<std::uint32_t>(granted->height);
  pix.field = V4L2_FIELD_NONE;
  const bool two_bytes = pix.pixelformat == V4L2_PIX_FMT_YUYV || pix.pixelformat == V4L2_PIX_FMT_UYVY;
  pix.bytesperline = pix.pixelformat == V4L2_PIX_FMT_MJPEG ? 0 : pix.width * (two_bytes ? 2 : 1);
  pix.sizeimage = static_cast<std::uint32_t>(c.buffer_bytes);
  if (keep) device.format = format;
  return 0;
}

int describe_interval(volatile Control& c, v4l2_frmivalenum& interval) {
  const auto* f = offered(c, interval.pixel_format, interval.width, interval.height);
  if (!f || interval.index > 0) return fail(EINVAL);
  interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  interval.discrete = {1, static_cast<std::uint32_t>(f->rate_hz)};
  return 0;
}

std::uint32_t stamp_flags(volatile Control& c) {
  switch (c.stamp_kind) {
    case 0: return V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    case 2: return V4L2_BUF_FLAG_TIMESTAMP_COPY;
    case 3: return V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
    default: return V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  }
}

int take(volatile Control& c, v4l2_buffer& buffer) {
  if (!something_to_take(clock_us(CLOCK_MONOTONIC))) return fail(EAGAIN);
  const Done done = device.done.front();
  device.done.pop_front();
  buffer.index = done.index;
  buffer.bytesused = done.bytes_used;
  buffer.length = static_cast<std::uint32_t>(page_rounded(c.buffer_bytes));
  buffer.m.offset = buffer.index * buffer.length;
  buffer.sequence = done.sequence;
  buffer.flags = stamp_flags(c) | (c.error_flag ? V4L2_BUF_FLAG_ERROR : 0);
  const std::int64_t stamp_us = c.stamp_kind == 1 ? 0 : done.exposed_us + c.stamp_shift_us;
  buffer.timestamp = {stamp_us / 1'000'000, stamp_us % 1'000'000};
  c.taken = c.taken + 1;
  return 0;
}

int start(volatile Control& c, bool on) {
  if (on && c.stream_errno) return fail(static_cast<int>(c.stream_errno));
  device.streaming = on;
  c.streaming = on;
  device.next_exposure_us = clock_us(CLOCK_MONOTONIC) + 1'000'000 / c.rate_hz;
  if (!on) {
    device.queued.clear();
    device.done.clear();
  }
  return 0;
}

int answer(volatile Control& c, unsigned long request, void* argument) {
  if (c.pulled_out) return fail(ENODEV);
  advance(c, clock_us(CLOCK_MONOTONIC));
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& capability = *static_cast<v4l2_capability*>(argument);
      capability = {};
      capability.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      auto& description = *static_cast<v4l2_fmtdesc*>(argument);
      if (description.index >= c.format_count) return fail(EINVAL);
      description.pixelformat = static_cast<std::uint32_t>(c.formats[description.index].fourcc);
      return 0;
    }
    case VIDIOC_TRY_FMT: return set_format(c, *static_cast<v4l2_format*>(argument), false);
    case VIDIOC_S_FMT: return set_format(c, *static_cast<v4l2_format*>(argument), true);
    case VIDIOC_G_FMT: *static_cast<v4l2_format*>(argument) = device.format; return 0;
    case VIDIOC_ENUM_FRAMEINTERVALS: return describe_interval(c, *static_cast<v4l2_frmivalenum*>(argument));
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {1, static_cast<std::uint32_t>(c.rate_hz)};
      return 0;
    case VIDIOC_REQBUFS: {
      auto& wish = *static_cast<v4l2_requestbuffers*>(argument);
      device.buffers = static_cast<int>(std::min(wish.count, 8U));
      wish.count = static_cast<std::uint32_t>(device.buffers);
      return ftruncate(device.fd, static_cast<off_t>(page_rounded(c.buffer_bytes) * wish.count));
    }
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      buffer.length = static_cast<std::uint32_t>(page_rounded(c.buffer_bytes));
      buffer.m.offset = buffer.index * buffer.length;
      buffer.flags = stamp_flags(c);
      return 0;
    }
    case VIDIOC_QBUF: device.queued.push_back(static_cast<v4l2_buffer*>(argument)->index); return 0;
    case VIDIOC_DQBUF: return take(c, *static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON: return start(c, true);
    case VIDIOC_STREAMOFF: return start(c, false);
    default: return fail(ENOTTY);
  }
}

bool is_fake(const char* path) {
  volatile Control* c = control();
  if (!c || !path) return false;
  char name[32];
  snprintf(name, sizeof name, "/dev/video%d", static_cast<int>(c->number));
  return strcmp(path, name) == 0;
}

int open_fake() {
  volatile Control& c = *control();
  const std::lock_guard lock(device_mutex);
  if (c.pulled_out) return fail(ENOENT);
  if (c.open_errno) return fail(static_cast<int>(c.open_errno));
  if (device.fd >= 0) return fail(EBUSY);
  device = Device{};
  device.fd = memfd_create("camera", MFD_CLOEXEC);
  c.opens = c.opens + 1;
  return device.fd;
}

bool owns(int fd) { return fd >= 0 && control() && fd == device.fd; }

}  // namespace

// --- what the program calls instead of the C library
// ---------------------------------------------------------------------
extern "C" {

#define FAKE_OPEN(NAME)                                                                       \
  int NAME(const char* path, int flags, ...) {                                                \
    if (is_fake(path)) return open_fake();                                                    \
    va_list arguments;                                                                        \
    va_start(arguments, flags);                                                               \
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0; \
    va_end(arguments);                                                                        \
    static const auto next = real<int (*)(const char*, int, ...)>(#NAME);                     \
    return next(path, flags, mode);                                                           \
  }
FAKE_OPEN(open)
FAKE_OPEN(open64)

#define FAKE_OPEN_2(NAME)                                            \
  int NAME(const char* path, int flags) {                            \
    if (is_fake(path)) return open_fake();                           \
    static const auto next = real<int (*)(const char*, int)>(#NAME); \
    return next(path, flags);                                        \
  }
FAKE_OPEN_2(__open_2)
FAKE_OPEN_2(__open64_2)

int access(const char* path, int mode) {
  if (is_fake(path)) return control()->pulled_out ? fail(ENOENT) : 0;
  static const auto next = real<int (*)(const char*, int)>("access");
  return next(path, mode);
}

int stat(const char* path, struct stat* about) {
  static const auto next = real<int (*)(const char*, struct stat*)>("stat");
  if (!is_fake(path)) return next(path, about);
  return control()->pulled_out ? fail(ENOENT) : next("/dev/null", about);
}

int close(int fd) {
  static const auto next = real<int (*)(int)>("close");
  if (owns(fd)) {
    const std::lock_guard lock(device_mutex);
    control()->closes = control()->closes + 1;
    control()->streaming = 0;
    device.fd = -1;
  }
  return next(fd);
}

int ioctl(int fd, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if (owns(fd)) {
    const std::lock_guard lock(device_mutex);
    return answer(*control(), request, argument);
  }
  static const auto next = real<int (*)(int, unsigned long, ...)>("ioctl");
  return next(fd, request, argument);
}

int poll(pollfd* fds, nfds_t count, int timeout_ms) {
  static const auto next = real<int (*)(pollfd*, nfds_t, int)>("poll");
  if (count != 1 || !owns(fds->fd)) return next(fds, count, timeout_ms);
  const std::int64_t deadline_us = clock_us(CLOCK_MONOTONIC) + std::int64_t{timeout_ms} * 1000;
  while (true) {
    const std::int64_t now_us = clock_us(CLOCK_MONOTONIC);
    {
      const std::lock_guard lock(device_mutex);
      volatile Control& c = *control();
      advance(c, now_us);
      fds->revents = 0;
      if (c.pulled_out || !device.streaming)
        fds->revents = POLLERR | POLLHUP;
      else if (something_to_take(now_us))
        fds->revents = POLLIN | POLLRDNORM;
    }
    if (fds->revents != 0) return 1;
    if (timeout_ms >= 0 && now_us >= deadline_us) return 0;
    usleep(500);  // the faults are switched from outside: there is nothing to wait on
  }
}

int clock_gettime(clockid_t clock, timespec* now) {
  static const auto next = real<int (*)(clockid_t, timespec*)>("clock_gettime");
  const int result = next(clock, now);
  if (clock != CLOCK_BOOTTIME || result != 0 || !control()) return result;
  const std::int64_t us = std::int64_t{now->tv_sec} * 1'000'000 + now->tv_nsec / 1'000 + control()->slept_us;
  *now = {us / 1'000'000, us % 1'000'000 * 1'000};
  return 0;
}

}  // extern "C"
