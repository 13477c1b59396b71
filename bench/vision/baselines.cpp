// ViSP's and libapriltag's trackers as a Python module. Both find every tag of an image and the pose of each; the clock
// runs in here, around detection and pose and nothing else, so that neither pays for Python. One thread each.
//
// Pixels: both count from the corner of the first pixel, so pixel centres are at +0.5. The intrinsics given here are
// in that convention: (cx + 0.5, cy + 0.5) of Pilotfish's CameraModel. The caller adds the half.

#include <apriltag/apriltag.h>
#include <apriltag/apriltag_pose.h>
#include <apriltag/tag36h11.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpImage.h>
#include <visp3/detection/vpDetectorAprilTag.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace {

using Image = py::array_t<std::uint8_t, py::array::c_style>;
using Pose = py::array_t<double>;

/// All tags of one image as (id, cMt (4, 4)), and the time it took.
struct Result {
  std::vector<std::pair<int, Pose>> tags;
  std::int64_t elapsed_ns = 0;
};

/// Pinhole with OpenCV's five coefficients, pixel centres at +0.5.
struct Lens {
  double fx, fy, cx, cy;
  std::vector<double> distortion;  ///< k1, k2, p1, p2, k3, or none
};

template <class Work>
std::int64_t elapsed_ns(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count();
}

template <class Rotation, class Translation>
Pose to_array(const Rotation& rotation, const Translation& translation) {
  Pose array({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) array.mutable_at(row, column) = row == column ? 1.0 : 0.0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) array.mutable_at(row, column) = rotation(row, column);
    array.mutable_at(row, 3) = translation(row);
  }
  return array;
}

/// vpDetectorAprilTag as its tutorial uses it. Distortion is ViSP's own model of one coefficient each way (kud, kdu).
class VispDetector {
 public:
  VispDetector(double decimation, double fx, double fy, double cx, double cy, double kud, double kdu)
      : detector_(vpDetectorAprilTag::TAG_36h11, vpDetectorAprilTag::HOMOGRAPHY_VIRTUAL_VS) {
    detector_.setAprilTagQuadDecimate(static_cast<float>(decimation));
    detector_.setAprilTagNbThreads(1);
    if (kud == 0.0 && kdu == 0.0)
      camera_.initPersProjWithoutDistortion(fx, fy, cx, cy);
    else
      camera_.initPersProjWithDistortion(fx, fy, cx, cy, kud, kdu);
  }

  Result track(const Image& image, double size_m) {
    if (image.ndim() != 2) throw py::value_error("expected an image (H, W)");
    image_.resize(static_cast<unsigned>(image.shape(0)), static_cast<unsigned>(image.shape(1)));
    std::copy_n(image.data(), image.size(), image_.bitmap);
    std::vector<vpHomogeneousMatrix> poses;
    Result result;
    result.elapsed_ns = elapsed_ns([&] { detector_.detect(image_, size_m, camera_, poses); });
    const std::vector<int> ids = detector_.getTagsId();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const vpHomogeneousMatrix& cMt = poses[i];
      const auto rotation = [&](int row, int column) { return cMt[row][column]; };
      result.tags.emplace_back(ids[i], to_array(rotation, [&](int row) { return cMt[row][3]; }));
    }
    return result;
  }

 private:
  vpDetectorAprilTag detector_;
  vpCameraParameters camera_;
  vpImage<unsigned char> image_;
};

/// libapriltag with its own pose: homography, then orthogonal iteration. It knows no lens; through one that distorts,
/// the corners are straightened by OpenCV before the pose is computed (within the time that is measured).
class AprilTagDetector {
 public:
  AprilTagDetector(double decimation, double fx, double fy, double cx, double cy, std::vector<double> distortion)
      : lens_{fx, fy, cx, cy, std::move(distortion)} {
    detector_->quad_decimate = static_cast<float>(decimation);
    detector_->nthreads = 1;
    apriltag_detector_add_family(detector_.get(), family_.get());
  }

  Result track(const Image& image, double size_m) {
    if (image.ndim() != 2) throw py::value_error("expected an image (H, W)");
    const auto height = static_cast<int>(image.shape(0)), width = static_cast<int>(image.shape(1));
    std::vector<std::uint8_t> pixels(image.data(), image.data() + image.size());
    image_u8_t view = {width, height, width, pixels.data()};
    struct Tag {
      int id;
      apriltag_pose_t pose;
    };
    std::vector<Tag> found;
    Result result;
    result.elapsed_ns = elapsed_ns([&] {
      zarray_t* detections = apriltag_detector_detect(detector_.get(), &view);
      for (int i = 0; i < zarray_size(detections); ++i) {
        apriltag_detection_t* detection = nullptr;
        zarray_get(detections, i, static_cast<void*>(&detection));
        if (!lens_.distortion.empty()) straighten(*detection);
        apriltag_detection_info_t info = {detection, size_m, lens_.fx, lens_.fy, lens_.cx, lens_.cy};
        found.push_back({detection->id, {}});
        estimate_tag_pose(&info, &found.back().pose);
      }
      apriltag_detections_destroy(detections);
    });
    for (Tag& tag : found) {
      const auto rotation = [&](int row, int column) { return MATD_EL(tag.pose.R, row, column); };
      result.tags.emplace_back(tag.id, to_array(rotation, [&](int row) { return MATD_EL(tag.pose.t, row, 0); }));
      std::free(tag.pose.R);  // one block each; Debian's library keeps matd_destroy() to itself
      std::free(tag.pose.t);
    }
    return result;
  }

 private:
  /// Corners and homography of the detection, as a camera without distortion would have them.
  void straighten(apriltag_detection_t& detection) const {
    const cv::Matx33d camera(lens_.fx, 0, lens_.cx, 0, lens_.fy, lens_.cy, 0, 0, 1);
    std::vector<cv::Point2d> seen, straight;
    for (const auto& corner : detection.p) seen.emplace_back(corner[0], corner[1]);
    const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-10);
    cv::undistortPoints(seen, straight, camera, lens_.distortion, cv::noArray(), camera, until);
    // libapriltag's corners 0..3 are (-1, 1), (1, 1), (1, -1), (-1, -1) of the tag.
    const cv::Point2f tag[4] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
    cv::Point2f image[4];
    for (int i = 0; i < 4; ++i) {
      detection.p[i][0] = straight[i].x;
      detection.p[i][1] = straight[i].y;
      image[i] = straight[i];
    }
    const cv::Matx33d homography = cv::getPerspectiveTransform(tag, image);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) MATD_EL(detection.H, row, column) = homography(row, column);
  }

  Lens lens_;
  std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family_{tag36h11_create(), tag36h11_destroy};
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_{apriltag_detector_create(),
                                                                                 apriltag_detector_destroy};
};

}  // namespace

PYBIND11_MODULE(bench_vision_baselines, m) {
  m.doc() = "ViSP's and libapriltag's detection and pose, timed where they run.";
  py::class_<Result>(m, "Result", "All tags of one image, and the time it took to find them and their poses.")
      .def_readonly("tags", &Result::tags, "list of (id, cMt (4, 4))")
      .def_readonly("elapsed_ns", &Result::elapsed_ns);
  py::class_<VispDetector>(m, "VispDetector", "vpDetectorAprilTag, 36h11, HOMOGRAPHY_VIRTUAL_VS, one thread.")
      .def(py::init<double, double, double, double, double, double, double>(), py::kw_only(), py::arg("decimation"),
           py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("kud") = 0.0, py::arg("kdu") = 0.0)
      .def("track", &VispDetector::track, py::arg("image"), py::arg("size_m"));
  py::class_<AprilTagDetector>(m, "AprilTagDetector", "libapriltag, 36h11, orthogonal iteration, one thread.")
      .def(py::init<double, double, double, double, double, std::vector<double>>(), py::kw_only(),
           py::arg("decimation"), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"),
           py::arg("distortion") = std::vector<double>{})
      .def("track", &AprilTagDetector::track, py::arg("image"), py::arg("size_m"));
}
