#include "pilotfish/bus/key.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <numeric>
#include <set>
#include <type_traits>

#include "pilotfish/core/parameter.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::bus;

using Bytes32 = std::array<std::uint8_t, Key::kBytes>;

static_assert(!std::is_convertible_v<Bytes32, Key>);  // nobody makes a key by accident
static_assert(std::is_same_v<decltype(std::declval<Key&>().bytes()), const Bytes32&>);

Bytes32 counted_bytes() {
  Bytes32 bytes{};
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

/// A file of its own with this content, and gone at the end.
class KeyFile {
 public:
  explicit KeyFile(const std::string& text, mode_t mode = 0600)
      : path_(testing::TempDir() + "pilotfish_key_" + std::to_string(::getpid())) {
    std::ofstream(path_) << text;
    ::chmod(path_.c_str(), mode);
  }
  KeyFile(const KeyFile&) = delete;
  KeyFile& operator=(const KeyFile&) = delete;
  ~KeyFile() { ::unlink(path_.c_str()); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string refused_key(const KeyFile& file) {
  return tests::refused_key([&] { load_key(file.path()); });
}

TEST(Key, IsWipedWhenItGoes) {
  alignas(Key) std::array<unsigned char, sizeof(Key)> place{};
  Key* key = new (place.data()) Key(counted_bytes());
  const volatile unsigned char* bytes = place.data();
  ASSERT_EQ(bytes[0], 1);
  key->~Key();
  for (std::size_t i = 0; i < Key::kBytes; ++i) EXPECT_EQ(bytes[i], 0) << i;
}

TEST(Key, IsWholeInACopyOfOneThatIsGone) {
  Key copy({});
  {
    const Key key(counted_bytes());
    copy = key;
  }
  EXPECT_EQ(copy.bytes(), counted_bytes());
}

TEST(LoadKey, ReadsWhatItsOwnerAloneMayRead) {
  std::string hex;
  for (int i = 0; i < 32; ++i) hex += "0a";
  Bytes32 tens{};
  tens.fill(10);
  EXPECT_EQ(load_key(KeyFile(hex).path()).bytes(), tens);
  EXPECT_EQ(load_key(KeyFile(hex + "\n").path()).bytes(), tens);
  EXPECT_EQ(load_key(KeyFile(hex + "\r\n").path()).bytes(), tens);
  EXPECT_EQ(refused_key(KeyFile(hex, 0640)), "key_file");
  EXPECT_EQ(refused_key(KeyFile(hex, 0604)), "key_file");
}

TEST(LoadKey, TakesNothingThatIsNearlyAKey) {
  const std::string hex(64, 'f');
  for (const std::string& text : {std::string(), hex.substr(1), hex + "f", hex + "\n\n", " " + hex, hex + " ",
                                  "0x" + hex.substr(2), hex.substr(1) + "g", std::string(64, '\0')})
    EXPECT_EQ(refused_key(KeyFile(text)), "key_file") << text;
}

TEST(LoadKey, LeavesNoFileOpenWhenItRefuses) {
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
  };
  const auto before = open_files();
  for (const char* path : {"/nowhere", "/", "/dev/zero", ""}) EXPECT_THROW(load_key(path), ConfigError) << path;
  EXPECT_EQ(refused_key(KeyFile("short")), "key_file");
  EXPECT_EQ(open_files(), before);
}

TEST(MessageMac, IsOfTheKeyTheChannelAndEveryByteBeforeIt) {
  const Key key(counted_bytes());
  std::vector<std::uint8_t> message(100, 3);
  const Mac mac = message_mac(key, "ROBOT1_COMMAND", message.data(), message.size());
  std::copy(mac.begin(), mac.end(), message.end() - 32);
  const auto is_right = [&](const Key& by, std::string_view channel) {
    return has_right_mac(by, channel, message.data(), message.size());
  };
  EXPECT_TRUE(is_right(key, "ROBOT1_COMMAND"));
  EXPECT_FALSE(is_right(key, "ROBOT2_COMMAND"));
  EXPECT_FALSE(is_right(Key({}), "ROBOT1_COMMAND"));
  for (std::size_t i = 0; i < message.size(); ++i) {
    message[i] ^= 0x80U;
    EXPECT_FALSE(is_right(key, "ROBOT1_COMMAND")) << i;
    message[i] ^= 0x80U;
  }
}

TEST(MessageMac, FitsNothingThatIsShorterThanItself) {
  const Key key(counted_bytes());
  const std::vector<std::uint8_t> message(31, 0);  // a sanitizer sees its end
  for (std::size_t size = 0; size <= message.size(); ++size)
    EXPECT_FALSE(has_right_mac(key, "C", message.data(), size)) << size;
  EXPECT_FALSE(has_right_mac(key, "C", nullptr, 0));
}

TEST(Session, IsPositiveAndNeverTheSame) {
  std::set<std::int64_t> sessions;
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t session = new_session_id();
    ASSERT_GT(session, 0);
    ASSERT_TRUE(sessions.insert(session).second);  // two of a thousand are the same once in 10^13 runs
  }
}

}  // namespace
