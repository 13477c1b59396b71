#include "visp_tags.hpp"

#include <visp3/core/vpPixelMeterConversion.h>
#include <visp3/vision/vpPose.h>

#include <array>
#include <vector>

#include "pilotfish/visp/conversions.hpp"

namespace pilotfish::bench {
namespace {

double area_px(const std::vector<vpImagePoint>& corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const vpImagePoint &here = corners[i], &next = corners[(i + 1) % corners.size()];
    twice += here.get_u() * next.get_v() - next.get_u() * here.get_v();
  }
  return std::abs(twice) / 2.0;
}

}  // namespace

/// vpDetectorAprilTag has pixel centres at +0.5, and a tag frame that is half a turn about x from ours.
VispTags::VispTags(const CameraModel& camera, const LeaderBody& body, double decimation)
    : detector_(vpDetectorAprilTag::TAG_36h11, vpDetectorAprilTag::HOMOGRAPHY_VIRTUAL_VS),
      camera_(camera.fx, camera.fy, camera.cx + 0.5, camera.cy + 0.5) {
  detector_.setAprilTagQuadDecimate(static_cast<float>(decimation));
  detector_.setAprilTagNbThreads(1);
  Eigen::Isometry3d half_turn = Eigen::Isometry3d::Identity();
  half_turn.linear().diagonal() << 1.0, -1.0, -1.0;
  for (const BodyTag& tag : body.tags) {
    tags_.emplace(tag.id, Tag{tag.size_m, body_from_tag(tag) * half_turn});
    sizes_m_[tag.id] = tag.size_m;
  }
  sizes_m_[-1] = body.tags.at(0).size_m;  // of tags that the leader does not wear
}

std::optional<Eigen::Isometry3d> VispTags::see(const vpImage<unsigned char>& picture) {
  if (!detector_.detect(picture)) return std::nullopt;
  const std::vector<int> ids = detector_.getTagsId();
  const std::vector<std::vector<vpImagePoint>> corners = detector_.getTagsCorners();
  const std::vector<std::vector<vpPoint>> points = detector_.getTagsPoints3D(ids, sizes_m_);
  vpPose pose;
  std::optional<std::size_t> largest;
  double largest_px = 0.0;
  int used = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto tag = tags_.find(ids[i]);
    if (tag == tags_.end()) continue;
    ++used;
    if (const double px = area_px(corners[i]); px > largest_px) {
      largest = i;
      largest_px = px;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d on_tag(points[i][k].get_oX(), points[i][k].get_oY(), points[i][k].get_oZ());
      const Eigen::Vector3d on_body = tag->second.oMt * on_tag;
      vpPoint point(on_body.x(), on_body.y(), on_body.z());
      double x = 0.0, y = 0.0;
      vpPixelMeterConversion::convertPoint(camera_, corners[i][k], x, y);
      point.set_x(x);
      point.set_y(y);
      pose.addPoint(point);
    }
  }
  if (!largest) return std::nullopt;
  const Tag& tag = tags_.at(ids[*largest]);
  vpHomogeneousMatrix cMt;
  if (!detector_.getPose(*largest, tag.size_m, camera_, cMt)) return std::nullopt;
  const Eigen::Isometry3d from_largest = visp::isometry_of(cMt) * tag.oMt.inverse();
  if (used == 1) return from_largest;
  vpHomogeneousMatrix cMo = visp::homogeneous_of(from_largest);
  try {
    if (!pose.computePose(vpPose::VIRTUAL_VS, cMo)) return from_largest;
  } catch (const vpException&) {
    return from_largest;
  }
  return visp::isometry_of(cMo);
}

}  // namespace pilotfish::bench
