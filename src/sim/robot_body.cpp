#include "pilotfish/sim/robot_body.hpp"

#include "tag_cells.hpp"

namespace pilotfish::sim {
namespace {

using Eigen::Vector3d;

/// A face of the box, looking along `outward` (a unit axis), with `right` and `down` as one looks at it.
Surface face(const RobotBody& body, const Vector3d& outward, const Vector3d& right, double brightness) {
  const Vector3d half = Vector3d(body.box_size_m[0], body.box_size_m[1], body.box_size_m[2]) / 2.0;
  const Vector3d centre(body.box_position_m[0], body.box_position_m[1], body.box_position_m[2]);
  const Vector3d down = right.cross(outward);  // right x down = inward = -outward
  Surface surface;
  surface.centre_m = centre + outward.cwiseProduct(half);
  surface.half_a_m = right.cwiseProduct(half);
  surface.half_b_m = down.cwiseProduct(half);
  surface.grays = {static_cast<float>(std::min(255.0, body.box_gray * brightness))};
  surface.back_gray = -1.0F;
  return surface;
}

Surface sheet(const RobotBody& body, const BodyTag& tag, const TagCells& cells) {
  const Eigen::Isometry3d oMt = body_from_tag(tag);
  const double half_m = tag.size_m / 2.0 * cells.cells / cells.black_square;
  Surface surface;
  surface.centre_m = oMt.translation();
  surface.half_a_m = oMt.linear().col(0) * half_m;
  surface.half_b_m = oMt.linear().col(1) * half_m;
  surface.cells = cells.cells;
  for (std::uint8_t gray : cells.grays)
    surface.grays.push_back(static_cast<float>(body.black_gray + (body.white_gray - body.black_gray) * gray / 255.0));
  surface.back_gray = static_cast<float>(body.box_gray * 0.6);
  surface.is_sheet = true;
  return surface;
}

}  // namespace

std::vector<Surface> surfaces_of(const RobotBody& body) {
  std::vector<Surface> surfaces;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  if (body.box_size_m[0] > 0.0 && body.box_size_m[1] > 0.0 && body.box_size_m[2] > 0.0) {
    // Lit from above and a little from its right, so that one sees the edges.
    surfaces.push_back(face(body, -x, -y, 1.0));
    surfaces.push_back(face(body, x, y, 1.0));
    surfaces.push_back(face(body, y, -x, 0.8));
    surfaces.push_back(face(body, -y, x, 1.15));
    surfaces.push_back(face(body, z, -y, 1.3));
    surfaces.push_back(face(body, -z, -y, 0.5));
  }
  std::vector<int> ids;
  for (const BodyTag& tag : body.leader.tags) ids.push_back(tag.id);
  const std::vector<TagCells> cells = tag_cells(body.leader.family, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) surfaces.push_back(sheet(body, body.leader.tags[i], cells[i]));
  return surfaces;
}

}  // namespace pilotfish::sim
