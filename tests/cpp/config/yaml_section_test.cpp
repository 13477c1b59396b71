#include "pilotfish/config/yaml_section.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "refused_key.hpp"
#include "scratch_folder.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::config;
using tests::refused_key;

constexpr int kFirst = std::numeric_limits<int>::min();
constexpr int kLast = std::numeric_limits<int>::max();

YamlSection section(const std::string& text) { return YamlSection::parse({"memory.yaml", text}); }

TEST(YamlSection, RefusesATextInMemoryThatIsNotUtf8AndOnWhichYamlCppNeverEnds) {
  EXPECT_EQ(refused_key([] { section(" ,\n\n\n\n\n\n\n\n\ne\xcb\xff\xff"); }), "file");
  EXPECT_EQ(refused_key([] { section(",-6_kp: 8.4655\xbf\xf5"); }), "file");
}

TEST(YamlSection, ReadsTheFirstAndTheLastIntegerAndNoneBeyond) {
  YamlSection ends = section("first: -2147483648\nlast: 2147483647\nbefore: -2147483649\nbeyond: 2147483648\n");
  EXPECT_EQ(ends.integer("first", kFirst, kLast), kFirst);
  EXPECT_EQ(ends.integer("last", kFirst, kLast), kLast);
  EXPECT_EQ(refused_key([&] { ends.integer("before", kFirst, kLast); }), "before");
  EXPECT_EQ(refused_key([&] { ends.integer("beyond", kFirst, kLast); }), "beyond");
}

TEST(YamlSection, TakesNoIntegerThatIsAlmostOne) {
  YamlSection almost = section("a: 5.0\nb: 5x\nc: 0x10\nd: ''\ne: [5]\nf: 1e2\n");
  for (const char* key : {"a", "b", "c", "d", "e", "f"})
    EXPECT_EQ(refused_key([&] { almost.integer(key, kFirst, kLast); }), key);
}

TEST(YamlSection, NamesTheWholeWayToAKey) {
  YamlSection root = section("outer:\n  list:\n    - {a: 1}\n    - {a: x}\n");
  YamlSection outer = root.section("outer");
  std::vector<YamlSection> list = outer.sections("list");
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].number("a", 0.0, 2.0), 1.0);
  EXPECT_EQ(refused_key([&] { list[1].number("a", 0.0, 2.0); }), "outer.list[1].a");
  EXPECT_EQ(refused_key([&] { list[0].number("b", 0.0, 2.0); }), "outer.list[0].b");
}

TEST(YamlSection, LetsNoNaNThroughABound) {
  YamlSection numbers = section("a: .nan\nb: .inf\nc: -.inf\nd: 1e999\n");
  for (const char* key : {"a", "b", "c", "d"}) EXPECT_EQ(refused_key([&] { numbers.number(key, -1e9, 1e9); }), key);
}

TEST(YamlSection, OutlivesTheTextItWasReadFrom) {
  std::optional<YamlSection> inner;
  {
    auto text = std::make_unique<TextFile>(TextFile{"memory.yaml", "outer: {speed_mps: 0.25}\n"});
    YamlSection root = YamlSection::parse(*text);
    inner = root.section("outer");
  }
  EXPECT_EQ(inner->number("speed_mps", 0.0, 1.0), 0.25);
  EXPECT_EQ(inner->file(), "memory.yaml");
}

TEST(YamlSection, RemembersWhatWasAskedAfterAMove) {
  YamlSection root = section("a: 1\nb: 2\n");
  root.number("a", 0.0, 9.0);
  YamlSection moved = std::move(root);
  EXPECT_EQ(refused_key([&] { moved.finish(); }), "b");
  moved.number("b", 0.0, 9.0);
  EXPECT_NO_THROW(moved.finish());
}

TEST(YamlSection, CanBeAskedThroughAConstReferenceWhatThereIs) {
  const YamlSection asked = section("angle_deg: 90\nb: 1\n");
  EXPECT_TRUE(asked.has("b"));
  EXPECT_FALSE(asked.has(""));
  EXPECT_FALSE(asked.has("c"));
  EXPECT_TRUE(asked.has_angle("angle_rad"));
  EXPECT_EQ(asked.keys(), (std::vector<std::string>{"angle_deg", "b"}));
}

TEST(YamlSection, TakesAnAngleInOneUnitOnly) {
  YamlSection degrees = section("angle_deg: 180\n"), both = section("angle_deg: 90\nangle_rad: 1\n");
  EXPECT_DOUBLE_EQ(degrees.angle("angle_rad", -kPi, kPi), kPi);  // the end of its range, which rounding must not cross
  EXPECT_EQ(refused_key([&] { both.angle("angle_rad", -kPi, kPi); }), "angle_deg");
}

TEST(YamlSection, IsNoneOfATextThatIsNoMapping) {
  for (const char* text : {"", "5", "[1, 2]", "a: [", "\t", "a: 1\n---\nb: 2\n"})
    EXPECT_THROW(section(text), ConfigError) << text;
  EXPECT_EQ(refused_key([] { section(std::string(65, '[') + std::string(65, ']')); }), "file");
}

TEST(TextFile, IsReadUpToItsLargestSizeAndNotAByteBeyond) {
  const tests::ScratchFolder folder;
  const auto largest = folder.write("a", std::string(kMaxTextBytes, '#'));
  const auto larger = folder.write("b", std::string(kMaxTextBytes + 1, '#'));
  EXPECT_EQ(read_text_file(largest).text.size(), kMaxTextBytes);
  EXPECT_EQ(refused_key([&] { read_text_file(larger, "leader"); }), "leader");
}

TEST(TextFile, NamesTheKeyThatNamedIt) {
  const tests::ScratchFolder folder;
  EXPECT_EQ(refused_key([&] { read_text_file(folder.path(), "camera.calibration"); }), "camera.calibration");
  EXPECT_EQ(refused_key([&] { read_text_file(folder.path() / "none", "fuzzy"); }), "fuzzy");
  EXPECT_EQ(refused_key([&] { read_text_file(std::string("a\0b", 3), "fuzzy"); }), "fuzzy");
}

}  // namespace
