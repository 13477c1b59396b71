#include "stop_on_fault.hpp"

#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>

#include "fault_signals.hpp"
#include "pilotfish/base/serial_protocol.hpp"

namespace pilotfish::apps {
namespace {

// A signal handler can reach nothing but globals, and call only what POSIX lists as safe there (write and tcflush are).
std::atomic<int> line_descriptor{-1};
std::array<char, 64> zero_line{};
std::size_t zero_size = 0;

void write_zero() {
  const int descriptor = line_descriptor.load();
  if (descriptor < 0) return;
  tcflush(descriptor, TCOFLUSH);
  // A failure cannot be reported any more.
  [[maybe_unused]] const ssize_t written = ::write(descriptor, zero_line.data(), zero_size);
}

}  // namespace

void prepare_stop_on_fault() {
  const base::SetPointLine line(0, {});
  zero_size = line.text().copy(zero_line.data(), zero_line.size());
  on_fault(write_zero);
}

void set_stop_on_fault_line(int descriptor) noexcept { line_descriptor = descriptor; }

}  // namespace pilotfish::apps
