#include "pilotfish/vision/tag_measurement.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tag_reading.hpp"
#include "tag_search.hpp"
#include "tag_warp.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kMinCorrelation = 0.35;  ///< below, the fit is not even tried
constexpr double kWrongFrameCells = 0.1;  ///< share of the rings that may be dirty
constexpr double kMaxOutliers = 0.25;     ///< share of the pixels that something else may explain
constexpr double kMinMargin_px = 1.0;     ///< of the corners from the picture's rim

bool is_inside(const ImageView& image, const std::array<Eigen::Vector2d, 4>& corners_px) {
  return std::all_of(corners_px.begin(), corners_px.end(), [&](const Eigen::Vector2d& corner) {
    return corner.x() >= kMinMargin_px && corner.y() >= kMinMargin_px &&
           corner.x() <= image.width - 1.0 - kMinMargin_px && corner.y() <= image.height - 1.0 - kMinMargin_px;
  });
}

double shorter_cell_px(const std::array<Eigen::Vector2d, 4>& c, double cell_side) {
  const double wide = std::min((c[1] - c[0]).norm(), (c[2] - c[3]).norm());
  const double high = std::min((c[0] - c[3]).norm(), (c[1] - c[2]).norm());
  return 0.5 * cell_side * std::min(wide, high);
}

}  // namespace

TagResult track_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                    const Eigen::Matrix3d& nHt, const Appearance& expected, double search_px, const BitGates& bits,
                    const TagGates& gates) noexcept {
  const std::array<Eigen::Vector2d, 4> guess_px = tag_corners_px(camera, TagWarp(camera, nHt));
  for (const Eigen::Vector2d& corner : guess_px)
    if (!(corner.cwiseAbs().maxCoeff() < 1e5)) return {std::nullopt, TagRefusal::not_found};
  if (shorter_cell_px(guess_px, pattern.cell_side) < 0.5 * gates.min_cell_px)
    return {std::nullopt, TagRefusal::too_small};
  const std::optional<Shift> shift = find_shift(image, camera, pattern, nHt, search_px);
  if (!shift) return {std::nullopt, TagRefusal::outside_frame};
  if (shift->correlation < kMinCorrelation)
    return {std::nullopt, is_inside(image, guess_px) ? TagRefusal::not_found : TagRefusal::outside_frame};

  Eigen::Matrix3d start = nHt;
  if (!shift->px.isZero()) {
    const Eigen::Vector2d middle = nHt.col(2).head<2>() / nHt(2, 2);
    const Eigen::Vector2d move = pixels_from_normalized(camera, middle).inverse() * shift->px;
    start.topRows<2>() += move * nHt.row(2);
  }
  const std::optional<Registration> fit = register_tag(image, camera, pattern, start, expected);
  if (!fit) return {std::nullopt, TagRefusal::not_found};
  if (!is_inside(image, fit->corners_px)) return {std::nullopt, TagRefusal::outside_frame};
  if (fit->cell_px < gates.min_cell_px) return {std::nullopt, TagRefusal::too_small};

  const TagReading reading = read_tag(image, camera, pattern, *fit);
  const bool other =
      reading.wrong_bits > bits.max_hamming || reading.wrong_frame_cells > kWrongFrameCells * reading.frame_cells;
  const double blur_px = std::sqrt(std::max(fit->appearance.blur_u_px2, fit->appearance.blur_v_px2));
  if (blur_px > gates.max_blur_cells * fit->cell_px) return {std::nullopt, TagRefusal::too_blurred};
  if (other) return {std::nullopt, TagRefusal::hamming};
  if (reading.decision_margin < bits.min_decision_margin) return {std::nullopt, TagRefusal::margin};
  if (fit->residual_rms > gates.max_normalised_residual * fit->appearance.contrast() ||
      fit->outlier_share > kMaxOutliers)
    return {std::nullopt, TagRefusal::residual};

  TagMeasurement measurement;
  measurement.tag = {pattern.id, reading.wrong_bits, reading.decision_margin, fit->corners_px};
  measurement.covariance_px2 = fit->covariance_px2;
  measurement.appearance = fit->appearance;
  return {measurement, TagRefusal::not_found};
}

// The unit square's corners to any quadrilateral, in closed form (Heckbert, "Fundamentals of texture mapping",
// 1989, 2.2.3): with the corners (0,0), (1,0), (1,1), (0,1) at p0 .. p3 and s = p0 - p1 + p2 - p3, d1 = p1 - p2, d2 =
// p3 - p2,
//
//   g = s x d2 / (d1 x d2),   h = d1 x s / (d1 x d2),   columns  (p1 - p0 + g p1, g), (p3 - p0 + h p3, h), (p0, 1).
Eigen::Matrix3d homography_from_corners(const CameraModel& camera,
                                        const std::array<Eigen::Vector2d, 4>& corners_px) noexcept {
  // Our corners are (-1, 1), (1, 1), (1, -1), (-1, -1): p0 = top left.
  const Eigen::Vector2d p0 = normalize_pixel(camera, corners_px[3]), p1 = normalize_pixel(camera, corners_px[2]),
                        p2 = normalize_pixel(camera, corners_px[1]), p3 = normalize_pixel(camera, corners_px[0]);
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
  const Eigen::Vector2d s = p0 - p1 + p2 - p3, d1 = p1 - p2, d2 = p3 - p2;
  const double g = cross(s, d2) / cross(d1, d2), h = cross(d1, s) / cross(d1, d2);
  Eigen::Matrix3d from_unit, unit_from_tag;
  from_unit.col(0) << p1 - p0 + g * p1, g;
  from_unit.col(1) << p3 - p0 + h * p3, h;
  from_unit.col(2) << p0, 1.0;
  unit_from_tag << 0.5, 0, 0.5, 0, 0.5, 0.5, 0, 0, 1;
  const Eigen::Matrix3d nHt = from_unit * unit_from_tag;
  return nHt / nHt(2, 2);
}

Eigen::Matrix3d homography_from_pose(const Eigen::Isometry3d& cMt, double size_m) noexcept {
  Eigen::Matrix3d nHt;
  nHt << 0.5 * size_m * cMt.linear().col(0), 0.5 * size_m * cMt.linear().col(1), cMt.translation();
  return nHt;
}

}  // namespace pilotfish::vision
