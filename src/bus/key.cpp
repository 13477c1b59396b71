#include "pilotfish/bus/key.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::bus {
namespace {

static_assert(Key::kBytes == crypto_auth_KEYBYTES);
static_assert(sizeof(Mac) == crypto_auth_BYTES);

constexpr std::size_t kHexDigits = 2 * Key::kBytes;

/// Before anything of libsodium; a second call does nothing.
void start_sodium() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be started");
}

struct Descriptor {
  int number;
  explicit Descriptor(int opened) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

[[noreturn]] void refuse(const std::string& path, const std::string& problem) {
  throw ConfigError("key_file", path + " " + problem);
}

/// The start of a regular file that only its owner may read. The open file is checked, not the name, so that it
/// cannot be exchanged in between; a pipe does not block.
std::size_t read_private(const std::string& path, char* text, std::size_t at_most) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat about {};
  if (file.number < 0 || ::fstat(file.number, &about) != 0)
    refuse(path, std::string("cannot be read: ") + std::strerror(errno));
  if (!S_ISREG(about.st_mode)) refuse(path, "is not a file");
  if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    refuse(path, "may be used by others than its owner, so it is no secret: chmod 600 " + path);
  const ssize_t count = ::read(file.number, text, at_most);
  if (count < 0) refuse(path, std::string("cannot be read: ") + std::strerror(errno));
  return static_cast<std::size_t>(count);
}

}  // namespace

Key::~Key() { sodium_memzero(bytes_.data(), bytes_.size()); }

Key load_key(const std::string& path) {
  start_sodium();
  std::array<char, kHexDigits + 3> text{};  // with a line end, and one more to see that there is more
  const std::size_t length = read_private(path, text.data(), text.size());
  std::array<std::uint8_t, Key::kBytes> bytes{};
  std::size_t read_bytes = 0;
  const char* end = nullptr;
  const bool is_hex = length >= kHexDigits && sodium_hex2bin(bytes.data(), bytes.size(), text.data(), kHexDigits,
                                                             nullptr, &read_bytes, &end) == 0;
  const std::string_view rest(text.data() + kHexDigits, length >= kHexDigits ? length - kHexDigits : 0);
  const bool good = is_hex && read_bytes == bytes.size() && end == text.data() + kHexDigits &&
                    (rest.empty() || rest == "\n" || rest == "\r\n");
  const bool zeros = sodium_is_zero(bytes.data(), bytes.size()) == 1;
  const Key key(bytes);
  sodium_memzero(text.data(), text.size());
  sodium_memzero(bytes.data(), bytes.size());
  if (!good)
    refuse(path, "must hold " + std::to_string(kHexDigits) + " hex digits and nothing else (pilotfish key new)");
  if (zeros) refuse(path, "holds zeros only, which anyone can guess; make a key with pilotfish key new");
  return key;
}

Mac message_mac(const Key& key, std::string_view channel, const void* encoded, std::size_t size_bytes) {
  Mac mac{};
  if (size_bytes < mac.size()) return mac;
  constexpr Mac kZeros{};
  constexpr std::uint8_t kSeparator = 0;
  // crypto_auth in pieces, so that nothing is copied.
  crypto_auth_hmacsha512256_state state;
  crypto_auth_hmacsha512256_init(&state, key.bytes().data(), key.bytes().size());
  const auto add = [&state](const void* data, std::size_t size) {
    crypto_auth_hmacsha512256_update(&state, static_cast<const unsigned char*>(data), size);
  };
  add(channel.data(), channel.size());
  add(&kSeparator, 1);
  add(encoded, size_bytes - mac.size());
  add(kZeros.data(), kZeros.size());
  crypto_auth_hmacsha512256_final(&state, mac.data());
  sodium_memzero(&state, sizeof(state));
  return mac;
}

bool has_right_mac(const Key& key, std::string_view channel, const void* encoded, std::size_t size_bytes) {
  if (size_bytes < sizeof(Mac)) return false;
  const Mac right = message_mac(key, channel, encoded, size_bytes);
  const auto* own = static_cast<const std::uint8_t*>(encoded) + (size_bytes - right.size());
  return crypto_verify_32(own, right.data()) == 0;
}

std::int64_t new_session_id() {
  start_sodium();
  std::int64_t session = 0;
  while (session == 0) {
    std::uint64_t bits = 0;
    randombytes_buf(&bits, sizeof(bits));
    session = static_cast<std::int64_t>(bits >> 1);  // 63 bits: never negative
  }
  return session;
}

}  // namespace pilotfish::bus
