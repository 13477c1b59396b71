#include "visp_world.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <stdexcept>

namespace pilotfish::bench {
namespace {

constexpr unsigned char kGround = 128;
constexpr unsigned kPixelsPerCell = 24;  // of the texture; ViSP's own examples use as fine ones
constexpr double kCellsWithin = 8.0;     // of tag36h11's black square; size_m is its side

/// A tag with its white margin of one cell.
vpImage<unsigned char> texture(int id) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* cells = apriltag_to_image(family, id);
  const auto side = static_cast<unsigned>(cells->width);
  vpImage<unsigned char> image(side * kPixelsPerCell, side * kPixelsPerCell);
  for (unsigned row = 0; row < image.getHeight(); ++row)
    for (unsigned column = 0; column < image.getWidth(); ++column)
      image[row][column] =
          cells
              ->buf[static_cast<int>(row / kPixelsPerCell) * cells->stride + static_cast<int>(column / kPixelsPerCell)];
  image_u8_destroy(cells);
  tag36h11_destroy(family);
  return image;
}

vpHomogeneousMatrix to_visp(const Eigen::Isometry3d& pose) {
  vpHomogeneousMatrix matrix;
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 4; ++column) matrix[row][column] = pose(row, column);
  return matrix;
}

Eigen::Isometry3d to_eigen(const vpHomogeneousMatrix& matrix) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 4; ++column) pose(row, column) = matrix[row][column];
  return pose;
}

/// vpDetectorAprilTag's tag frame is half a turn about x from ours (x right, y down, z into the paper).
Eigen::Isometry3d half_turn() {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear().diagonal() << 1.0, -1.0, -1.0;
  return turn;
}

}  // namespace

VispWorld::VispWorld(const CameraModel& camera, const LeaderBody& leader, double decimation)
    : leader_(leader),
      drawn_(camera.fx, camera.fy, camera.cx, camera.cy),
      detected_(camera.fx, camera.fy, camera.cx + 0.5, camera.cy + 0.5),
      image_(static_cast<unsigned>(camera.height), static_cast<unsigned>(camera.width), kGround),
      detector_(vpDetectorAprilTag::TAG_36h11, vpDetectorAprilTag::HOMOGRAPHY_VIRTUAL_VS) {
  detector_.setAprilTagQuadDecimate(static_cast<float>(decimation));
  detector_.setAprilTagNbThreads(1);
  for (const BodyTag& tag : leader_.tags) {
    const vpImage<unsigned char> sheet = texture(tag.id);
    const double half_m =
        0.5 * tag.size_m / kCellsWithin * static_cast<double>(sheet.getWidth()) / static_cast<double>(kPixelsPerCell);
    vpColVector corners[4];  // top left, top right, bottom right, bottom left
    const double x[] = {-half_m, half_m, half_m, -half_m}, y[] = {-half_m, -half_m, half_m, half_m};
    for (int corner = 0; corner < 4; ++corner) {
      corners[corner].resize(3);
      corners[corner][0] = x[corner];
      corners[corner][1] = y[corner];
    }
    vpImageSimulator& simulator = sheets_.emplace_back(vpImageSimulator::GRAY_SCALED);
    simulator.setInterpolationType(vpImageSimulator::BILINEAR_INTERPOLATION);
    simulator.init(sheet, corners);
  }
}

const vpImage<unsigned char>& VispWorld::render(const Eigen::Isometry3d& cMo) {
  image_ = kGround;
  for (std::size_t i = 0; i < sheets_.size(); ++i) {
    sheets_[i].setCameraPosition(to_visp(cMo * body_from_tag(leader_.tags[i])));
    sheets_[i].getImage(image_, drawn_);
  }
  return image_;
}

std::optional<Eigen::Isometry3d> VispWorld::detect() {
  std::vector<vpHomogeneousMatrix> poses;
  // The detector takes one size for all; a leader's tags are as large.
  if (!detector_.detect(image_, leader_.tags.front().size_m, detected_, poses)) return std::nullopt;
  const std::vector<int> ids = detector_.getTagsId();
  std::optional<Eigen::Isometry3d> best;
  double largest_px2 = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (const BodyTag& tag : leader_.tags) {
      const vpRect box = detector_.getBBox(i);
      if (tag.id != ids[i] || box.getWidth() * box.getHeight() <= largest_px2) continue;
      largest_px2 = box.getWidth() * box.getHeight();
      best = to_eigen(poses[i]) * half_turn() * body_from_tag(tag).inverse();
    }
  return best;
}

}  // namespace pilotfish::bench
