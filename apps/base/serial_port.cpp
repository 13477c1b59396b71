#include "serial_port.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace pilotfish::apps {
namespace {

/// More unsent bytes than this, and the other end does not take them at our rate: three of our longest lines.
constexpr int kMuchUnsent_bytes = 120;

speed_t speed_of(int baud) {
  for (const auto& [number, speed] :
       {std::pair{9600, B9600}, std::pair{19200, B19200}, std::pair{38400, B38400}, std::pair{57600, B57600},
        std::pair{115200, B115200}, std::pair{230400, B230400}, std::pair{460800, B460800}, std::pair{500000, B500000},
        std::pair{921600, B921600}, std::pair{1000000, B1000000}, std::pair{2000000, B2000000},
        std::pair{4000000, B4000000}})
    if (number == baud) return speed;
  throw SerialError(std::to_string(baud) + " baud is not a speed that the system knows");
}

[[noreturn]] void fail(const std::string& what) { throw SerialError(what + ": " + std::strerror(errno)); }

/// With what to do about it: the lines that there are, or the right that is missing.
std::string why_not_opened(const std::string& device, int problem) {
  std::string text = "cannot open the serial line " + device + ": " + std::strerror(problem);
  if (problem == EACCES) return text + "; does your user belong to the group dialout? (sudo usermod -aG dialout $USER)";
  if (problem != ENOENT) return text;
  std::string there;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/serial/by-id", none))
    there += (there.empty() ? "" : ", ") + entry.path().string();
  return text +
         (there.empty() ? "; no serial line is plugged in (/dev/serial/by-id lists them)" : "; there is: " + there);
}

void set_up(int descriptor, const std::string& device, speed_t speed) {
  if (isatty(descriptor) == 0) throw SerialError(device + " is not a serial line");
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) throw SerialError(device + " is in use by another program");
  ioctl(descriptor, TIOCEXCL);  // for programs that do not use the lock
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) fail(device);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | HUPCL | CSTOPB);
  settings.c_cc[VMIN] = 1;  // so that a read of nothing gives EAGAIN, and 0 only where the line has been hung up
  settings.c_cc[VTIME] = 0;
  cfsetispeed(&settings, speed);
  cfsetospeed(&settings, speed);
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0) fail(device);
  tcflush(descriptor, TCIOFLUSH);
}

}  // namespace

SerialPort::SerialPort(const std::string& device, int baud) {
  const speed_t speed = speed_of(baud);
  descriptor_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) throw SerialError(why_not_opened(device, errno));
  try {
    set_up(descriptor_, device, speed);
  } catch (const SerialError&) {
    ::close(descriptor_);
    throw;
  }
}

SerialPort::~SerialPort() {
  if (blocked_) tcflush(descriptor_, TCOFLUSH);  // else close() waits for unsent bytes
  ::close(descriptor_);
}

SerialPort::Written SerialPort::write_newest(std::string_view line) {
  blocked_ = true;
  const Written written = write_or_flush(line);
  blocked_ = written != Written::all;
  return written;
}

SerialPort::Written SerialPort::write_or_flush(std::string_view line) {
  Written written = Written::all;
  int unsent_bytes = 0;
  if (ioctl(descriptor_, TIOCOUTQ, &unsent_bytes) == 0 && unsent_bytes > kMuchUnsent_bytes) {
    tcflush(descriptor_, TCOFLUSH);
    written = Written::after_flush;
  }
  for (int attempt = 0; attempt < 2; ++attempt) {
    const ssize_t sent = ::write(descriptor_, line.data(), line.size());
    if (sent == static_cast<ssize_t>(line.size())) return written;
    if (sent < 0 && errno != EAGAIN && errno != EINTR) fail("write");
    // No room, or for a part only: what comes next begins with a $, so half a line does no harm.
    tcflush(descriptor_, TCOFLUSH);
    written = Written::after_flush;
  }
  return Written::nothing;
}

std::size_t SerialPort::read(char* buffer, std::size_t size) {
  const ssize_t got = ::read(descriptor_, buffer, size);
  if (got > 0) return static_cast<std::size_t>(got);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  if (got == 0) throw SerialError("the line has been hung up");
  fail("read");
}

bool SerialPort::output_empty() const noexcept {
  int unsent_bytes = 0;
  return ioctl(descriptor_, TIOCOUTQ, &unsent_bytes) != 0 || unsent_bytes == 0;
}

}  // namespace pilotfish::apps
