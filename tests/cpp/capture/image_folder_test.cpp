#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <type_traits>

#include "pilotfish/capture/frame_source.hpp"
#include "scratch_folder.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::capture;
using tests::ScratchFolder;

static_assert(std::has_virtual_destructor_v<FrameSource>);
static_assert(std::is_base_of_v<std::runtime_error, CaptureError>);
static_assert(std::is_nothrow_copy_constructible_v<CaptureError>);  // it can be thrown on without a second failure

/// A gray picture of 20 x 16 pixels of one level.
std::string flat(int level) { return "P5\n20 16\n255\n" + std::string(20 * 16, static_cast<char>(level)); }

std::unique_ptr<FrameSource> open(const ScratchFolder& folder, double rate_hz = 30.0) {
  return open_images(folder.path().string(), rate_hz);
}

std::string refusal(const std::string& folder, double rate_hz = 30.0) {
  try {
    open_images(folder, rate_hz);
  } catch (const CaptureError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(ImageFolder, GivesFramesThatOutliveIt) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  auto source = open(folder);
  const std::optional<Frame> frame = source->next();
  source.reset();
  std::filesystem::remove(folder.path() / "1.pgm");
  ASSERT_TRUE(frame);
  ASSERT_EQ(check(frame->image), Reason::none);
  EXPECT_EQ(frame->image.width, 20);
  EXPECT_EQ(frame->image.height, 16);
  EXPECT_EQ(frame->image.data[0], 90);
}

TEST(ImageFolder, GivesEachFramePixelsOfItsOwn) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  folder.write("2.pgm", flat(91));
  const auto source = open(folder);
  const auto first = source->next(), second = source->next();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->image.data[0], 90);
  EXPECT_EQ(second->image.data[0], 91);
}

TEST(ImageFolder, SaysWhyItHasEndedAndStaysSo) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  const auto source = open(folder);
  EXPECT_FALSE(source->ended());
  EXPECT_EQ(source->why_ended(), "");
  EXPECT_TRUE(source->next());
  for (int again = 0; again < 3; ++again) {
    EXPECT_FALSE(source->next());
    EXPECT_EQ(source->why_ended(), "no more pictures");
  }
}

TEST(ImageFolder, CountsAPictureThatVanishedAfterItWasOpened) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  folder.write("2.pgm", flat(91));
  const auto source = open(folder);
  std::filesystem::remove(folder.path() / "1.pgm");
  const auto vanished = source->next(), there = source->next();
  ASSERT_TRUE(vanished && there);
  EXPECT_EQ(vanished->image.width, 0);
  EXPECT_NE(check(vanished->image), Reason::none);
  EXPECT_EQ(there->utime, 33'333);  // in its place all the same
}

TEST(ImageFolder, TakesTheFirstAndTheLastStampThereIs) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  folder.write("frames.csv", "file,utime_us\n1.pgm,-9223372036854775808\n1.pgm,9223372036854775807\n1.pgm,0\n");
  const auto source = open(folder);
  EXPECT_EQ(source->next()->utime, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(source->next()->utime, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(source->next()->utime, 0);
}

TEST(ImageFolder, RefusesAStampOneBeyondTheLast) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  folder.write("frames.csv", "file,utime_us\n1.pgm,9223372036854775808\n");
  EXPECT_NE(refusal(folder.path().string()).find("line 2"), std::string::npos);
}

TEST(ImageFolder, RefusesARateAtWhichItsLastPictureHasNoStamp) {
  const ScratchFolder folder;
  for (int i = 0; i < 3; ++i) folder.write(std::to_string(i) + ".pgm", flat(90));
  // The third is 2e6 / rate us after the first, and an int64 ends at 9.22e18 us: 2.17e-13 Hz.
  for (double rate_hz : {std::numeric_limits<double>::denorm_min(), 1e-300, 2.1e-13})
    EXPECT_NE(refusal(folder.path().string(), rate_hz).find("frame rate"), std::string::npos) << rate_hz;
  const auto slow = open(folder, 2.2e-13);
  slow->next();
  slow->next();
  EXPECT_NEAR(static_cast<double>(slow->next()->utime), 2e6 / 2.2e-13, 1024.0);  // doubles are 1024 apart there
}

TEST(ImageFolder, RefusesARateThatIsNone) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  for (double rate_hz : {0.0, -30.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_NE(refusal(folder.path().string(), rate_hz).find("frame rate"), std::string::npos) << rate_hz;
}

TEST(ImageFolder, CanBeAskedWhatItIsThroughAConstReference) {
  const ScratchFolder folder;
  folder.write("1.pgm", flat(90));
  const auto source = open(folder);
  const FrameSource& asked = *source;
  EXPECT_FALSE(asked.live());
  EXPECT_EQ(asked.describe(), "images in " + folder.path().string() + " (1 pictures, 30 Hz)");
}

TEST(FrameSource, SaysWhatCannotBeOpened) {
  const ScratchFolder folder;
  const std::string none = (folder.path() / "none").string();
  EXPECT_EQ(refusal(none), "there is no folder " + none);
  EXPECT_NE(refusal(folder.path().string()).find("there are no pictures"), std::string::npos);
  EXPECT_THROW(open_video(none), CaptureError);
  EXPECT_THROW(open_video(folder.path().string()), CaptureError);
  EXPECT_THROW(open_video(folder.write("no.mp4", "no video").string()), CaptureError);
  for (int index : {-1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
    EXPECT_THROW(open_camera(index, 640, 480, 30.0), CaptureError) << index;
}

}  // namespace
