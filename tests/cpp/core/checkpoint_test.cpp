#include "pilotfish/core/checkpoint.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace {

using pilotfish::BoundedVector;
using pilotfish::Bytes;
using pilotfish::CheckpointReader;
using pilotfish::CheckpointWriter;

/// One of everything that can be remembered.
struct Memory {
  std::int64_t utime = 0;
  bool started = false;
  std::optional<double> error_m;
  BoundedVector<std::int64_t, 4> stamps;
  std::array<double, 2> claims{};
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {
    archive(self.utime, self.started, self.error_m, self.stamps, self.claims, self.covariance);
  }
};

Memory full_memory() {
  Memory memory;
  memory.utime = std::numeric_limits<std::int64_t>::min();
  memory.started = true;
  memory.error_m = -0.25;
  memory.stamps.push_back(7);
  memory.stamps.push_back(8);
  memory.claims = {1.5, -2.5};
  memory.covariance << 1, 2, 3, 4;
  return memory;
}

Bytes written(const Memory& memory) {
  Bytes bytes;
  CheckpointWriter writer(bytes);
  writer(memory);
  return bytes;
}

TEST(Checkpoint, HasNoByteBesidesTheValues) {
  // 8 utime, 1 bool, 1 + 8 optional, 8 + 2 * 8 list, 2 * 8 array, 4 * 8 matrix.
  EXPECT_EQ(written(full_memory()).size(), 8U + 1 + 9 + 24 + 16 + 32);
  // Without a value and without elements: 8 of the optional and 16 of the list less.
  EXPECT_EQ(written(Memory{}).size(), 90U - 8 - 16);
}

TEST(Checkpoint, GivesBackEveryBit) {
  const Bytes bytes = written(full_memory());
  Memory back;
  CheckpointReader reader(bytes);
  reader(back);
  EXPECT_TRUE(reader.read_all());
  EXPECT_EQ(written(back), bytes);
  EXPECT_EQ(back.stamps.back(), 8);
  EXPECT_EQ(back.covariance(1, 0), 3.0);
}

TEST(Checkpoint, ClearsWhatWasNotThereWhenItWasWritten) {
  const Bytes bytes = written(Memory{});
  Memory back = full_memory();
  CheckpointReader reader(bytes);
  reader(back);
  EXPECT_TRUE(reader.read_all());
  EXPECT_FALSE(back.error_m.has_value());
  EXPECT_TRUE(back.stamps.empty());
}

TEST(Checkpoint, SaysOfEveryShorterTextThatItIsNotWhole) {
  const Bytes bytes = written(full_memory());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));  // a sanitizer sees its end
    Memory back;
    CheckpointReader reader(cut);
    reader(back);
    EXPECT_FALSE(reader.read_all()) << size << " bytes of " << bytes.size();
  }
}

TEST(Checkpoint, SaysOfALongerTextThatItIsNotRead) {
  Bytes bytes = written(full_memory());
  bytes.push_back(0);
  Memory back;
  CheckpointReader reader(bytes);
  reader(back);
  EXPECT_FALSE(reader.read_all());
}

TEST(Checkpoint, AcceptsNoCountBeyondAListsCapacity) {
  for (std::uint64_t count : {std::uint64_t{5}, std::numeric_limits<std::uint64_t>::max()}) {
    Bytes bytes;
    CheckpointWriter writer(bytes);
    writer(count);
    bytes.resize(bytes.size() + 8 * 8);  // what would be read if it were accepted
    BoundedVector<std::int64_t, 4> list;
    list.push_back(42);
    CheckpointReader reader(bytes);
    reader(list);
    EXPECT_FALSE(reader.read_all());
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list.front(), 42);
  }
}

TEST(Checkpoint, ReadsNothingAnyMoreAfterItHasFailed) {
  const Bytes bytes(4, 0xFF);
  CheckpointReader reader(bytes);
  std::int64_t eight_bytes = 1;
  std::uint8_t one_byte = 2;
  reader(eight_bytes, one_byte);  // the second would fit
  EXPECT_EQ(eight_bytes, 1);
  EXPECT_EQ(one_byte, 2);
  EXPECT_FALSE(reader.read_all());
}

TEST(Checkpoint, MakesATruthOfAnyByteThatIsNotZero) {
  const Bytes bytes = {2, 0xFF, 0};  // a bool object that holds 2 is undefined behaviour
  bool two = false, all = false, none = true;
  CheckpointReader reader(bytes);
  reader(two, all, none);
  EXPECT_TRUE(two);
  EXPECT_TRUE(all);
  EXPECT_FALSE(none);
}

TEST(Checkpoint, IsWholeWhenNothingIsAskedOfNothing) {
  const Bytes nothing;
  EXPECT_TRUE(CheckpointReader(nothing).read_all());
}

}  // namespace
