#include "pilotfish/core/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace pilotfish {
namespace {

struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

FileRead refused(const std::filesystem::path& file, const std::string& why) {
  return {std::nullopt, file.string() + " " + why};
}

FileRead unreadable(const std::filesystem::path& file, int error) {
  return {std::nullopt, "cannot read " + file.string() + ": " + std::strerror(error)};
}

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

FileRead not_a_file(const std::filesystem::path& file, mode_t mode) {
  return refused(file, std::string("is ") + kind_of(mode) + ", not a file; name a regular file");
}

FileRead too_large(const std::filesystem::path& file, std::size_t max_bytes) {
  return refused(file, "is too large; at most " + std::to_string(max_bytes) + " bytes are read");
}

}  // namespace

FileRead read_file(const std::filesystem::path& file, std::size_t max_bytes) {
  // A name with a zero byte inside would be a different file for the system than the one shown in the message.
  if (file.native().find('\0') != std::string::npos) return unreadable(file, EINVAL);
  // Not blocking: opening a pipe without a writer would wait for one. The type is checked on the open descriptor,
  // since the file could be exchanged in between.
  const Descriptor descriptor{::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)};
  struct stat status {};
  if (descriptor.value < 0) {
    const int error = errno;
    if (error == ENXIO && ::stat(file.c_str(), &status) == 0) return not_a_file(file, status.st_mode);  // a socket
    return unreadable(file, error);
  }
  if (::fstat(descriptor.value, &status) != 0) return unreadable(file, errno);
  if (!S_ISREG(status.st_mode)) return not_a_file(file, status.st_mode);
  if (static_cast<std::uintmax_t>(status.st_size) > max_bytes) return too_large(file, max_bytes);

  // The size is only a hint: it may grow while it is read, and files of /proc report 0.
  std::string bytes(static_cast<std::size_t>(status.st_size) + 1, '\0');
  std::size_t size = 0;
  while (true) {
    const ssize_t count = ::read(descriptor.value, bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return unreadable(file, errno);
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
    if (size > max_bytes) return too_large(file, max_bytes);
    if (size == bytes.size()) bytes.resize(std::min(2 * size, max_bytes + 1));
  }
  bytes.resize(size);
  return {std::move(bytes), ""};
}

}  // namespace pilotfish
