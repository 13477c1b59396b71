#pragma once

#include <visp3/core/vpImage.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "pilotfish/sim/renderer.hpp"

namespace pilotfish::bench {

/// Pictures of tags at given poses, as ViSP's images: for bench/visp and tests/visp.
class RenderedTags {
 public:
  /// `ids`: of tag36h11. size_m: side of their black squares.
  RenderedTags(const CameraModel& camera, const std::vector<int>& ids, double size_m,
               const sim::Imperfections& imperfections, std::uint64_t seed)
      : renderer_(camera, {}, imperfections, seed) {
    for (const int id : ids) {
      BodyTag tag;
      tag.id = id;
      tag.size_m = size_m;
      sim::RobotBody body;
      body.leader.tags = {tag};
      surfaces_.push_back(sim::surfaces_of(body));
      tMo_.push_back(body_from_tag(tag).inverse());
    }
  }

  /// cMt: pose of each tag (x right, y down, z into the paper) in the camera's frame [m]; nothing: it is not there.
  vpImage<unsigned char> picture(const std::vector<std::optional<Eigen::Isometry3d>>& cMt,
                                 std::uint64_t noise_seed) const {
    sim::View view;
    for (std::size_t i = 0; i < cMt.size(); ++i)
      if (cMt[i]) view.bodies.push_back({&surfaces_[i], *cMt[i] * tMo_[i]});
    const std::vector<std::uint8_t> pixels = renderer_.render({view}, noise_seed);
    const CameraModel& camera = renderer_.camera();
    vpImage<unsigned char> image(static_cast<unsigned>(camera.height), static_cast<unsigned>(camera.width));
    std::memcpy(image.bitmap, pixels.data(), pixels.size());
    return image;
  }

 private:
  sim::Renderer renderer_;
  std::vector<std::vector<sim::Surface>> surfaces_;
  std::vector<Eigen::Isometry3d> tMo_;
};

}  // namespace pilotfish::bench
