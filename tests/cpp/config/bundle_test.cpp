#include "pilotfish/config/bundle.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <type_traits>

#include "pilotfish/config/base_file.hpp"
#include "refused_key.hpp"
#include "scratch_folder.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::config;
using tests::refused_key;
using tests::ScratchFolder;

static_assert(std::is_copy_constructible_v<CoordinatorFile>);
static_assert(std::is_move_constructible_v<ConfigBundle>);

const std::filesystem::path kData = PILOTFISH_DATA;

/// A leader of one tag of 0.16 m, whose name tells which file it came from.
std::string leader(const std::string& name) {
  return "name: " + name +
         "\nfamily: tag36h11\ntags:\n  - {id: 0, size_m: 0.16, position_m: [0, 0, 0.25], facing_deg: 180}\n";
}

ConfigBundle line() { return bundle_config(kData / "config/line.yaml", {}); }

std::size_t folders_left() {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::temp_directory_path()))
    count += entry.path().filename().string().rfind("pilotfish-", 0) == 0 ? 1 : 0;
  return count;
}

TEST(ConfigBundle, MakesTheSameCoordinatorWhereItsFilesAreNot) {
  const CoordinatorFile there = load_coordinator(kData / "config/line.yaml"), here = load_bundle(line());
  EXPECT_EQ(here.name, there.name);
  EXPECT_EQ(here.coordinator.camera.fx, there.coordinator.camera.fx);
  EXPECT_EQ(here.coordinator.leader.tags.size(), there.coordinator.leader.tags.size());
  EXPECT_EQ(here.coordinator.control.law.rules.consequents, there.coordinator.control.law.rules.consequents);
}

TEST(ConfigBundle, MakesTheSameInWhateverOrderItsFilesCome) {
  // The leader's name in the configuration is that of a file on this computer, which must not be looked at.
  const ScratchFolder folder;
  ConfigBundle bundle = line();
  const auto named = [&](const std::string& role) {
    return std::find_if(bundle.files.begin(), bundle.files.end(), [&](const auto& each) { return each.role == role; });
  };
  ASSERT_NE(named("leader"), bundle.files.end());
  named("leader")->text = leader("recorded");
  const std::string here = folder.write("leader.yaml", leader("here")).string();
  std::string& config = named("config")->text;
  const std::size_t at = config.find("\nleader: ");
  ASSERT_NE(at, std::string::npos);
  config.replace(at, config.find('\n', at + 1) - at, "\nleader: " + here);
  EXPECT_EQ(load_bundle(bundle).coordinator.leader.name, "recorded");
  std::reverse(bundle.files.begin(), bundle.files.end());
  EXPECT_EQ(load_bundle(bundle).coordinator.leader.name, "recorded");
}

TEST(ConfigBundle, LeavesNoFolderBehindEvenIfItThrows) {
  const ScratchFolder own;  // a place for temporary files that no other test uses
  setenv("TMPDIR", own.path().c_str(), 1);
  load_bundle(line());
  EXPECT_EQ(folders_left(), 0U);
  ConfigBundle broken = line();
  broken.files.back().text = "[";
  EXPECT_THROW(load_bundle(broken), ConfigError);
  EXPECT_EQ(folders_left(), 0U);
  unsetenv("TMPDIR");
}

TEST(ConfigBundle, NamesTheFileThatARecordingLacks) {
  ConfigBundle bundle = line();
  const auto fuzzy =
      std::find_if(bundle.files.begin(), bundle.files.end(), [](const auto& each) { return each.role == "fuzzy"; });
  ASSERT_NE(fuzzy, bundle.files.end());
  bundle.files.erase(fuzzy);
  EXPECT_EQ(refused_key([&] { load_bundle(bundle); }), "fuzzy");
  EXPECT_EQ(refused_key([] { load_bundle({}); }), "file");
}

TEST(ConfigBundle, IsNotMadeOfWhatIsNoFile) {
  // Neither an exception of another kind nor a wait for a writer.
  const ScratchFolder folder;
  EXPECT_EQ(refused_key([&] { bundle_config(folder.path(), {}); }), "file");
  EXPECT_EQ(refused_key([&] { bundle_config(folder.path() / "none", {}); }), "file");
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(refused_key([&] { bundle_config(pipe, {}); }), "file");
  const auto config = folder.write("c.yaml", "leader: .\n");
  EXPECT_EQ(refused_key([&] { bundle_config(config, {}); }), "leader");
  ConfigOverrides overrides;
  overrides.tuning = folder.path().string();
  const auto empty = folder.write("e.yaml", "name: robot1\n");
  EXPECT_EQ(refused_key([&] { bundle_config(empty, overrides); }), "--tuning");
}

TEST(ConfigBundle, TakesNoTextThatIsTooLargeOrNestedWithoutEnd) {
  const ScratchFolder folder;
  const auto large = folder.write("large.yaml", "a: " + std::string(kMaxTextBytes, 'b'));
  EXPECT_EQ(refused_key([&] { bundle_config(large, {}); }), "file");
  const auto deep = folder.write("deep.yaml", "a: " + std::string(1000, '[') + std::string(1000, ']'));
  EXPECT_EQ(refused_key([&] { bundle_config(deep, {}); }), "file");
}

TEST(CoordinatorFile, IsACopyOfItsOwn) {
  const CoordinatorFile file = load_coordinator(kData / "config/line.yaml");
  CoordinatorFile copy = file;
  copy.coordinator.leader.tags.clear();
  copy.coordinator.control.law.rules.consequents.clear();
  EXPECT_FALSE(file.coordinator.leader.tags.empty());
  EXPECT_EQ(file.coordinator.control.law.rules.consequents.size(), 56U);
}

TEST(Tuning, LeavesTheConfigurationAsItWasIfItThrows) {
  control::FollowerConfig config = load_coordinator(kData / "config/line.yaml").coordinator.control;
  const double speed = config.limits.max_linear_mps;
  // The first key is right and the second is not.
  EXPECT_EQ(refused_key([&] {
              parse_tuning({"t.yaml", "limits: {max_linear_mps: 0.123}\nlimitz: {}\n"}, config);
            }),
            "limitz");
  EXPECT_EQ(config.limits.max_linear_mps, speed);
}

TEST(WheelDriver, IsOneOfThree) {
  EXPECT_EQ(driver_from("dry_run").kind, WheelDriver::Kind::dry_run);
  EXPECT_EQ(driver_from("serial:/dev/x").device, "/dev/x");
  for (const char* text : {"", "serial", "serial:", "Simulator", "dry_run "})
    EXPECT_EQ(refused_key([&] { driver_from(text); }), "driver") << text;
}

}  // namespace
