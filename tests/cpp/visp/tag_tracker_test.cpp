#include "pilotfish/visp/tag_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "../vision/tag_picture.hpp"
#include "pilotfish/visp/conversions.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;
using tests::refused_key;
using visp::TagTracker;

static_assert(std::is_nothrow_move_constructible_v<TagTracker>);
static_assert(std::is_nothrow_move_assignable_v<TagTracker>);
static_assert(!std::is_copy_constructible_v<TagTracker>);
static_assert(!std::is_convertible_v<std::string, TagTracker>);

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSize_m = 0.16;

/// 64 pixels of a tag of 0.16 m at 400 px: it is 400 * 0.16 / 64 = 1 m away, and right ahead.
vpCameraParameters camera() {
  vpCameraParameters camera;
  camera.initPersProjWithoutDistortion(400.0, 400.0, 99.5, 99.5);
  return camera;
}

vpImage<unsigned char> picture(int id = 7) { return visp::image_of(tests::tag_frame(id)); }

TEST(VispTagTracker, StillFollowsAfterAMove) {
  TagTracker tracker;
  std::vector<vpHomogeneousMatrix> poses;
  ASSERT_TRUE(tracker.detect(picture(), kSize_m, camera(), poses));
  TagTracker moved = std::move(tracker);
  ASSERT_TRUE(moved.detect(picture(), kSize_m, camera(), poses));
  EXPECT_EQ(moved.wholePictureSearches(), 1);  // it knew where the tag was
  EXPECT_NEAR(poses[0][2][3], 1.0, 0.01);
  TagTracker other;
  other = std::move(moved);
  ASSERT_TRUE(other.detect(picture(), kSize_m, camera(), poses));
  EXPECT_EQ(other.wholePictureSearches(), 1);
}

TEST(VispTagTracker, MovesItsSettingsToo) {
  TagTracker tracker;
  tracker.setZAlignedWithCameraAxis(true);
  TagTracker moved = std::move(tracker);
  std::vector<vpHomogeneousMatrix> poses;
  ASSERT_TRUE(moved.detect(picture(), kSize_m, camera(), poses));
  EXPECT_NEAR(poses[0][2][2], 1.0, 0.01);  // z into the paper, which is ahead; the other way it were -1
}

TEST(VispTagTracker, KeepsNothingOfThePicture) {
  TagTracker tracker;
  {
    auto short_lived = std::make_unique<vpImage<unsigned char>>(picture());
    ASSERT_TRUE(tracker.detect(*short_lived));
  }
  // libapriltag's square is that of the black cells: the pixels 68 to 131, so its middle is 99.5.
  EXPECT_NEAR(tracker.getCog(0).get_u(), 99.5, 0.5);
  vpHomogeneousMatrix pose;
  EXPECT_TRUE(tracker.getPose(0, kSize_m, camera(), pose));
  EXPECT_NEAR(pose[2][3], 1.0, 0.02);
}

TEST(VispTagTracker, CanBeAskedThroughAConstReference) {
  TagTracker tracker;
  tracker.detect(picture());
  const TagTracker& asked = tracker;
  EXPECT_EQ(asked.getTagsId(), std::vector<int>{7});
  EXPECT_EQ(asked.getMessage(0), "36h11 id: 7");
  EXPECT_EQ(asked.getTagsCorners().size(), 1U);
  EXPECT_EQ(asked.getPolygon(0).size(), 4U);
}

TEST(VispTagTracker, HasNoTagBeyondTheLast) {
  TagTracker tracker;
  tracker.detect(picture());
  for (std::size_t beyond : {std::size_t{1}, std::numeric_limits<std::size_t>::max()}) {
    EXPECT_THROW(tracker.getPolygon(beyond), std::out_of_range);
    EXPECT_THROW(tracker.getMessage(beyond), std::out_of_range);
    EXPECT_THROW(tracker.getBBox(beyond), std::out_of_range);
    EXPECT_THROW(tracker.getCog(beyond), std::out_of_range);
    vpHomogeneousMatrix pose;
    EXPECT_FALSE(tracker.getPose(beyond, kSize_m, camera(), pose));
  }
}

TEST(VispTagTracker, NamesTheSettingThatCannotBe) {
  EXPECT_EQ(refused_key([] { TagTracker("tag99h9"); }), "leader.family");
  TagTracker tracker;
  for (float decimation : {0.0F, 1.25F, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_EQ(refused_key([&] { tracker.setAprilTagQuadDecimate(decimation); }), "vision.decimation") << decimation;
  EXPECT_EQ(refused_key([&] { tracker.setSearchPeriod(std::numeric_limits<int>::min()); }), "search_period");
  for (double rate_hz : {0.0, 1e9, kNone, -kInfinity})
    EXPECT_EQ(refused_key([&] { tracker.setFrameRate(rate_hz); }), "frame_rate_hz") << rate_hz;
  EXPECT_TRUE(tracker.detect(picture()));  // it goes on as it was
}

TEST(VispTagTracker, GoesOnAfterACallThatThrew) {
  TagTracker tracker;
  std::vector<vpHomogeneousMatrix> poses;
  ASSERT_TRUE(tracker.detect(picture(), kSize_m, camera(), poses));
  for (double size_m : {0.0, -0.16, kNone, kInfinity})
    EXPECT_EQ(refused_key([&] { tracker.detect(picture(), size_m, camera(), poses); }), "tag_size_m") << size_m;
  vpCameraParameters fisheye;
  fisheye.initProjWithKannalaBrandtDistortion(400.0, 400.0, 99.5, 99.5, {0.1, 0.0, 0.0, 0.0});
  EXPECT_EQ(refused_key([&] { tracker.detect(picture(), kSize_m, fisheye, poses); }), "camera.distortion");
  ASSERT_TRUE(tracker.detect(picture(), kSize_m, camera(), poses));
  EXPECT_EQ(tracker.wholePictureSearches(), 1);  // the tag it follows is not lost
}

TEST(VispTagTracker, SeesNothingInAPictureThatIsNone) {
  TagTracker tracker;
  std::vector<vpHomogeneousMatrix> poses(3);
  EXPECT_FALSE(tracker.detect(vpImage<unsigned char>(), kSize_m, camera(), poses));
  EXPECT_TRUE(poses.empty());
  EXPECT_FALSE(tracker.detect(vpImage<unsigned char>(15, 200, 0)));
  EXPECT_EQ(tracker.getNbObjects(), 0U);
}

TEST(Conversions, GiveAFrameOfTheSamePixelsAndACopyBack) {
  vpImage<unsigned char> image = picture();
  const Frame frame = visp::frame_of(image, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(frame.image.data, image.bitmap);
  EXPECT_EQ(frame.utime, std::numeric_limits<std::int64_t>::min());
  vpImage<unsigned char> copy = visp::image_of(frame);
  EXPECT_NE(copy.bitmap, image.bitmap);
  EXPECT_TRUE(copy == image);
}

TEST(Conversions, LeaveThePaddingBetweenRowsOut) {
  std::vector<std::uint8_t> padded(40 * 15 + 20, 255);
  for (std::size_t v = 0; v < 16; ++v) std::fill_n(&padded[v * 40], 20, static_cast<std::uint8_t>(v));
  Frame frame;
  frame.image = {padded.data(), padded.size(), 20, 16, 40};
  const vpImage<unsigned char> image = visp::image_of(frame);
  ASSERT_EQ(image.getWidth(), 20U);
  ASSERT_EQ(image.getHeight(), 16U);
  for (unsigned int v = 0; v < 16; ++v) EXPECT_EQ(image[v][19], v);
}

TEST(Conversions, MakeNoImageOfPixelsThatCannotBeRead) {
  Frame lies;
  std::uint8_t pixel = 0;
  lies.image = {&pixel, 1, 640, 480, 640};
  EXPECT_EQ(visp::image_of(lies).getSize(), 0U);
}

TEST(Conversions, RefuseALensThatTheOtherSideDoesNotHave) {
  CameraModel model{200, 200, 400.0, 400.0, 99.5, 99.5};
  model.k1 = -0.1;
  EXPECT_EQ(visp::camera_parameters_of(model).get_kud(), -0.1);
  model.p1 = 1e-3;
  EXPECT_EQ(refused_key([&] { visp::camera_parameters_of(model); }), "camera.distortion");
  EXPECT_EQ(refused_key([] { visp::camera_model_of(camera(), 0, 200); }), "camera.width");
  EXPECT_EQ(refused_key([] { visp::camera_model_of(camera(), std::numeric_limits<int>::max(), 200); }), "camera.width");
}

TEST(Conversions, BringAMotionThereAndBackToTheBit) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0).toRotationMatrix();
  motion.translation() = Eigen::Vector3d(0.1, -0.2, 1.0 / 3.0);
  EXPECT_EQ(visp::isometry_of(visp::homogeneous_of(motion)).matrix(), motion.matrix());
}

}  // namespace
