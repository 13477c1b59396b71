// visp_probe conversions     what becomes of ViSP's types and Pilotfish's on the way to the other side
// visp_probe refusals        what TagTracker does with what it cannot use
// visp_probe tags            pictures of tags, rendered, to TagTracker and to vpDetectorAprilTag
//
// All write one JSON object a line. `tags` reads one from its standard input:
//   camera       [width, height, f, cx, cy, k1]
//   ids, size_m  of the tags
//   noise        in gray levels
//   pictures     per picture and tag the pose cMt (16 numbers row by row; x right, y down, z into the paper) or null
//   configured_size_m  the detectors' configured size instead of size_m
//   decimation, search_period, z_aligned, without_pose     TagTracker's settings; without_pose: detect(I),
//   then
//                                                          getPose()
// and answers every picture with {"searches", "ours": [...], "visp": [...]}, tags as {"id", "pose", "corners" [u, v],
// "message", "box" [left, top, right, bottom], "cog" [u, v]}.

#include <visp3/detection/vpDetectorAprilTag.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

#include "pilotfish/core/parameter.hpp"
#include "pilotfish/visp/conversions.hpp"
#include "pilotfish/visp/tag_tracker.hpp"
#include "rendered_tags.hpp"

namespace {

using nlohmann::json;
using namespace pilotfish;

json as_json(const vpHomogeneousMatrix& pose) { return std::vector<double>(pose.data, pose.data + 16); }

json as_json(const CameraModel& c) { return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3}; }

json as_json(const vpCameraParameters& c) {
  return {c.get_px(),
          c.get_py(),
          c.get_u0(),
          c.get_v0(),
          c.get_kud(),
          c.get_kdu(),
          c.get_projModel() == vpCameraParameters::perspectiveProjWithDistortion};
}

template <class Work>
json refusal_of(const Work& work) {
  try {
    work();
    return nullptr;
  } catch (const ConfigError& error) {
    return error.key();
  }
}

Eigen::Isometry3d isometry_from(const json& numbers) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 12; ++i) result.matrix()(i / 4, i % 4) = numbers.at(static_cast<std::size_t>(i)).get<double>();
  return result;
}

int print_conversions() {
  json facts;
  vpImage<unsigned char> image(20, 30);  // rows, columns
  for (unsigned int v = 0; v < 20; ++v)
    for (unsigned int u = 0; u < 30; ++u) image[v][u] = static_cast<unsigned char>(v * 10 + u % 10);
  const Frame frame = visp::frame_of(image, 123'456);
  facts["same_pixels_in_memory"] = frame.image.data == image.bitmap;
  facts["frame"] = {frame.utime, frame.image.width, frame.image.height, frame.image.stride_bytes,
                    frame.image.size_bytes};
  vpImage<unsigned char> back = visp::image_of(frame);
  facts["image_back_is_equal"] = back == image;
  facts["image_back_is_a_copy"] = back.bitmap != image.bitmap;
  facts["image_of_nothing_is_empty"] = visp::image_of(Frame{}).getSize() == 0;

  vpCameraParameters pinhole, lens, fisheye;
  pinhole.initPersProjWithoutDistortion(600.0, 610.0, 320.0, 240.0);
  lens.initPersProjWithDistortion(600.0, 610.0, 320.0, 240.0, -0.2, 0.25);
  fisheye.initProjWithKannalaBrandtDistortion(600.0, 610.0, 320.0, 240.0, {0.1, 0.01, 0.0, 0.0, 0.0});
  facts["pinhole"] = as_json(visp::camera_model_of(pinhole, 640, 480));
  facts["lens"] = as_json(visp::camera_model_of(lens, 640, 480));
  facts["pinhole_back"] = as_json(visp::camera_parameters_of(visp::camera_model_of(pinhole, 640, 480)));
  facts["lens_back"] = as_json(visp::camera_parameters_of(visp::camera_model_of(lens, 640, 480)));
  facts["fisheye_refused"] = refusal_of([&] { visp::camera_model_of(fisheye, 640, 480); });
  CameraModel two_coefficients = visp::camera_model_of(lens, 640, 480);
  two_coefficients.k2 = 0.01;
  facts["two_coefficients_refused"] = refusal_of([&] { visp::camera_parameters_of(two_coefficients); });

  const vpHomogeneousMatrix cMo(0.1, -0.2, 1.5, 0.3, -0.4, 0.5);
  const Eigen::Isometry3d isometry = visp::isometry_of(cMo);
  facts["motion_back"] = as_json(visp::homogeneous_of(isometry)) == as_json(cMo);
  const Eigen::Vector3d moved = isometry * Eigen::Vector3d(0.7, 0.8, 0.9);
  const vpTranslationVector by_visp = cMo * vpTranslationVector(0.7, 0.8, 0.9);
  facts["same_motion_of_a_point"] = (moved - Eigen::Vector3d(by_visp[0], by_visp[1], by_visp[2])).norm();
  std::puts(facts.dump().c_str());
  return 0;
}

int print_refusals() {
  json facts;
  visp::TagTracker tracker;
  std::vector<vpHomogeneousMatrix> poses(3);
  vpHomogeneousMatrix pose;
  const vpCameraParameters pinhole(600.0, 600.0, 320.0, 240.0);
  vpCameraParameters fisheye;
  fisheye.initProjWithKannalaBrandtDistortion(600.0, 600.0, 320.0, 240.0, {0.1, 0.01, 0.0, 0.0, 0.0});
  const vpImage<unsigned char> gray(480, 640, 128), tiny(8, 8, 128), nothing;
  facts["unknown_family"] = refusal_of([] { visp::TagTracker("tag36h12"); });
  facts["size_zero"] = refusal_of([&] { tracker.detect(gray, 0.0, pinhole, poses); });
  facts["fisheye"] = refusal_of([&] { tracker.detect(gray, 0.1, fisheye, poses); });
  facts["no_focal_length"] = refusal_of([&] { tracker.detect(gray, 0.1, {1e-6, 1e-6, 320.0, 240.0}, poses); });
  facts["decimation"] = refusal_of([&] { tracker.setAprilTagQuadDecimate(2.5F); });
  facts["search_period"] = refusal_of([&] { tracker.setSearchPeriod(-1); });
  facts["frame_rate"] = refusal_of([&] { tracker.setFrameRate(0.0); });
  facts["seen"] = {tracker.detect(gray, 0.1, pinhole, poses), tracker.detect(tiny, 0.1, pinhole, poses),
                   tracker.detect(nothing, 0.1, pinhole, poses), tracker.detect(nothing),
                   tracker.getPose(0, 0.1, pinhole, pose)};
  facts["poses"] = poses.size();
  try {
    tracker.getMessage(0);
  } catch (const std::out_of_range&) {
    facts["no_such_tag"] = true;
  }
  std::puts(facts.dump().c_str());
  return 0;
}

/// Of either detector: their calls are the same.
template <class Detector>
json tags_of(Detector& detector, const std::vector<vpHomogeneousMatrix>& poses) {
  json tags = json::array();
  for (std::size_t i = 0; i < detector.getNbObjects(); ++i) {
    json corners = json::array();
    for (const vpImagePoint& corner : detector.getPolygon(i)) corners.push_back({corner.get_u(), corner.get_v()});
    const vpRect box = detector.getBBox(i);
    const vpImagePoint cog = detector.getCog(i);
    tags.push_back({{"id", detector.getTagsId()[i]},
                    {"pose", as_json(poses.at(i))},
                    {"corners", corners},
                    {"message", detector.getMessage(i)},
                    {"box", {box.getLeft(), box.getTop(), box.getRight(), box.getBottom()}},
                    {"cog", {cog.get_u(), cog.get_v()}}});
  }
  return tags;
}

int track_tags() {
  const json request = json::parse(std::cin);
  const std::vector<double> numbers = request.at("camera");
  CameraModel camera;
  camera.width = static_cast<int>(numbers.at(0));
  camera.height = static_cast<int>(numbers.at(1));
  camera.fx = camera.fy = numbers.at(2);
  camera.cx = numbers.at(3);
  camera.cy = numbers.at(4);
  camera.k1 = numbers.at(5);
  const vpCameraParameters cam = visp::camera_parameters_of(camera);
  const double size_m = request.at("size_m");
  sim::Imperfections imperfections;
  imperfections.noise_sigma = request.at("noise");
  const bench::RenderedTags scene(camera, request.at("ids"), size_m, imperfections, 1);

  const double configured_size_m = request.value("configured_size_m", size_m);

  visp::TagTracker ours;
  ours.setAprilTagQuadDecimate(request.value("decimation", 1.0F));
  ours.setSearchPeriod(request.value("search_period", 10));
  ours.setZAlignedWithCameraAxis(request.value("z_aligned", false));
  vpDetectorAprilTag theirs;
  theirs.setZAlignedWithCameraAxis(request.value("z_aligned", false));
  std::uint64_t seed = 0;
  for (const json& tags : request.at("pictures")) {
    std::vector<std::optional<Eigen::Isometry3d>> cMt;
    for (const json& pose : tags) {
      cMt.emplace_back();
      if (!pose.is_null()) cMt.back() = isometry_from(pose);
    }
    const vpImage<unsigned char> image = scene.picture(cMt, ++seed);
    std::vector<vpHomogeneousMatrix> poses, by_visp;
    if (request.value("without_pose", false)) {
      ours.detect(image);
      poses.resize(ours.getNbObjects());
      for (std::size_t i = 0; i < poses.size(); ++i)
        if (!ours.getPose(i, configured_size_m, cam, poses[i])) return 1;
    } else {
      ours.detect(image, configured_size_m, cam, poses);
    }
    theirs.detect(image, configured_size_m, cam, by_visp);
    const json line = {
        {"searches", ours.wholePictureSearches()}, {"ours", tags_of(ours, poses)}, {"visp", tags_of(theirs, by_visp)}};
    std::puts(line.dump().c_str());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string_view what = argc == 2 ? argv[1] : "";
  if (what == "conversions") return print_conversions();
  if (what == "refusals") return print_refusals();
  if (what == "tags") return track_tags();
  std::fputs("visp_probe conversions | refusals | tags\n", stderr);
  return 64;
} catch (const std::exception& error) {
  std::fprintf(stderr, "visp_probe: %s\n", error.what());
  return 1;
}
