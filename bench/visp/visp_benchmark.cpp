// ViSP's vpDetectorAprilTag and TagTracker on the same rendered pictures, one after the other in turns, one thread
// each.
//
//   visp_benchmark PICTURES TAGS SEED
//
// Prints a line of JSON for each tracker and picture: {"tracker", "row", "picture", "elapsed_ns", "tags": [{"id",
// "truth", "pose"}]}, row: to sort by; with every tag that is in the picture, poses as 16 numbers row by row (null
// where the tracker did not see it). The clock runs around detection and poses, and nothing else.
//
// vpDetectorAprilTag has pixel centres at +0.5. Its rows get a principal point of (u0 + 0.5, v0 + 0.5), except for the
// one that is named "as calibrated".

#include <visp3/detection/vpDetectorAprilTag.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "pilotfish/visp/conversions.hpp"
#include "pilotfish/visp/tag_tracker.hpp"
#include "rendered_tags.hpp"

namespace {

using Poses = std::vector<vpHomogeneousMatrix>;
constexpr double kSize_m = 0.16, kRate_hz = 30.0, kPi = 3.14159265358979323846;

struct Tracker {
  std::string name;
  std::function<std::vector<int>(const vpImage<unsigned char>&, Poses&)> track;  ///< ids and poses
};

template <class Detector>
Tracker tracker(const std::string& name, std::shared_ptr<Detector> detector, const vpCameraParameters& camera) {
  return {name, [detector, camera](const vpImage<unsigned char>& image, Poses& poses) {
            detector->detect(image, kSize_m, camera, poses);
            return detector->getTagsId();
          }};
}

Tracker visp(const std::string& name, float decimation, double shift_px, const pilotfish::CameraModel& camera,
             vpDetectorAprilTag::vpPoseEstimationMethod method = vpDetectorAprilTag::HOMOGRAPHY_VIRTUAL_VS) {
  auto detector = std::make_shared<vpDetectorAprilTag>(vpDetectorAprilTag::TAG_36h11, method);
  detector->setAprilTagQuadDecimate(decimation);
  detector->setAprilTagNbThreads(1);
  return tracker(name, detector, {camera.fx, camera.fy, camera.cx + shift_px, camera.cy + shift_px});
}

Tracker ours(const std::string& name, int search_period, const pilotfish::CameraModel& camera) {
  auto detector = std::make_shared<pilotfish::visp::TagTracker>();
  detector->setSearchPeriod(search_period);
  return tracker(name, detector, pilotfish::visp::camera_parameters_of(camera));
}

/// Tag `i` of `count` at the time t: side by side, 0.7 to 2.5 m away, to and fro at up to 0.4 m/s, yaw up to 60 and
/// pitch up to 15 degrees.
Eigen::Isometry3d pose_at(double t, int i, int count) {
  const double phase = 2.0 * i;
  Eigen::Isometry3d cMt = Eigen::Isometry3d::Identity();
  const double nearest_m = count == 1 ? 0.7 : 1.3;
  const double z = nearest_m + 0.5 * (2.5 - nearest_m) * (1.0 - std::cos(0.4 * t + phase));
  const double column_m = count == 1 ? 0.0 : 0.35 * (i - 0.5 * (count - 1));
  cMt.translation() << column_m + 0.08 * std::sin(0.9 * t + phase), 0.06 * std::cos(0.7 * t + phase), z;
  cMt.linear() = (Eigen::AngleAxisd(kPi / 3.0 * std::sin(0.5 * t + phase), Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(kPi / 12.0 * std::sin(0.8 * t + phase), Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  return cMt;
}

nlohmann::json as_json(const vpHomogeneousMatrix& pose) { return std::vector<double>(pose.data, pose.data + 16); }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("visp_benchmark PICTURES TAGS SEED\n", stderr);
    return 64;
  }
  const int pictures = std::atoi(argv[1]), count = std::atoi(argv[2]);
  const auto seed = static_cast<std::uint64_t>(std::atoll(argv[3]));
  pilotfish::CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  std::vector<int> ids;
  for (int i = 0; i < count; ++i) ids.push_back(i);
  const pilotfish::bench::RenderedTags scene(camera, ids, kSize_m, {}, seed);
  const std::vector<Tracker> trackers = {
      ours("TagTracker", 10, camera),
      ours("TagTracker, period 0", 0, camera),
      ours("TagTracker, period 1", 1, camera),
      visp("ViSP, 1:1", 1.0F, 0.5, camera),
      visp("ViSP, 1:2", 2.0F, 0.5, camera),
      visp("ViSP, 1:1, best residual", 1.0F, 0.5, camera, vpDetectorAprilTag::BEST_RESIDUAL_VIRTUAL_VS),
      visp("ViSP, 1:1, as calibrated", 1.0F, 0.0, camera)};
  // vpDetectorAprilTag's tag frame: half a turn about x.
  Eigen::Isometry3d half_turn = Eigen::Isometry3d::Identity();
  half_turn.linear().diagonal() << 1.0, -1.0, -1.0;

  std::mt19937_64 random(seed);
  std::vector<std::size_t> order(trackers.size());
  std::iota(order.begin(), order.end(), 0U);
  for (int k = 0; k < pictures; ++k) {
    std::vector<std::optional<Eigen::Isometry3d>> cMt;
    for (int i = 0; i < count; ++i) cMt.emplace_back(pose_at(k / kRate_hz, i, count));
    const vpImage<unsigned char> image = scene.picture(cMt, seed * 1'000'000 + static_cast<std::uint64_t>(k));
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t turn : order) {
      const Tracker& each = trackers[turn];
      Poses poses;
      const auto begin = std::chrono::steady_clock::now();
      const std::vector<int> seen = each.track(image, poses);
      const std::chrono::nanoseconds elapsed = std::chrono::steady_clock::now() - begin;
      nlohmann::json tags = nlohmann::json::array();
      for (int i = 0; i < count; ++i) {
        nlohmann::json tag = {
            {"id", i},
            {"truth", as_json(pilotfish::visp::homogeneous_of(*cMt[static_cast<std::size_t>(i)] * half_turn))},
            {"pose", nullptr}};
        for (std::size_t j = 0; j < seen.size() && j < poses.size(); ++j)
          if (seen[j] == i) tag["pose"] = as_json(poses[j]);
        tags.push_back(tag);
      }
      const nlohmann::json line = {
          {"tracker", each.name}, {"row", turn}, {"picture", k}, {"elapsed_ns", elapsed.count()}, {"tags", tags}};
      std::puts(line.dump().c_str());
    }
  }
}
