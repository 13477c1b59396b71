// Loaded into a program with LD_PRELOAD: whenever the file named by PILOTFISH_STALL appears, it is removed, and the
// next command leaves 150 ms after the program sent it. So does one when the process is stopped, or loses its core,
// after the last look at the clock that it could have.
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

extern "C" ssize_t sendmsg(int fd, const msghdr* message, int flags) {
  using SendMsg = ssize_t (*)(int, const msghdr*, int);
  static const auto real = reinterpret_cast<SendMsg>(dlsym(RTLD_NEXT, "sendmsg"));
  static const char* const file = getenv("PILOTFISH_STALL");
  for (size_t i = 0; file != nullptr && i < message->msg_iovlen; ++i)
    if (memmem(message->msg_iov[i].iov_base, message->msg_iov[i].iov_len, "_COMMAND", 8) != nullptr &&
        unlink(file) == 0) {
      const timespec stall{0, 150'000'000};
      nanosleep(&stall, nullptr);
    }
  return real(fd, message, flags);
}
