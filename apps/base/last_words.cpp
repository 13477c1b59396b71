#include "last_words.hpp"

#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "pilotfish/base/serial_protocol.hpp"

namespace pilotfish::apps {
namespace {

// A signal handler can reach nothing but globals, and call only what POSIX lists as safe there (write and tcflush are).
std::atomic<int> line_descriptor{-1};
std::array<char, 64> zero_line{};
std::size_t zero_size = 0;

void say_zero() noexcept {
  const int descriptor = line_descriptor.load();
  if (descriptor < 0) return;
  tcflush(descriptor, TCOFLUSH);
  // Nobody is left to be told that it failed.
  [[maybe_unused]] const ssize_t written = ::write(descriptor, zero_line.data(), zero_size);
}

/// The handler was installed to run once (SA_RESETHAND): raised again, the signal does what it does by default.
void on_broken(int number) {
  say_zero();
  raise(number);
}

}  // namespace

void prepare_last_words() {
  const base::SetPointLine line(0, {});
  zero_size = line.text().copy(zero_line.data(), zero_line.size());
  struct sigaction action {};
  action.sa_handler = on_broken;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP, SIGXCPU, SIGXFSZ})
    sigaction(number, &action, nullptr);
  std::set_terminate([] {
    say_zero();
    std::abort();
  });
}

void last_words_to(int descriptor) noexcept { line_descriptor = descriptor; }

}  // namespace pilotfish::apps
