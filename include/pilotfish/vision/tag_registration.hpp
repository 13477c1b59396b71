#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/vision/tag_pattern.hpp"
#include "pilotfish/vision/uneven_light.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

using Matrix8d = Eigen::Matrix<double, 8, 8>;

/// The appearance of a template in a picture: the levels of black and white, their slopes over it, and the blur.
struct Appearance {
  double black = 40.0;                                       ///< gray level in the middle of the tag
  double white = 215.0;                                      ///< the same
  Eigen::Vector2d black_slope = Eigen::Vector2d::Zero();     ///< change of black per tag coordinate: uneven light
  Eigen::Vector2d contrast_slope = Eigen::Vector2d::Zero();  ///< the same of white less black
  double blur_u_px2 = 0.6;                           ///< variance of the blur along rows (with the pixel's own 1/12)
  double blur_v_px2 = 0.6;                           ///< along columns
  double contrast() const { return white - black; }  ///< white minus black, in gray levels
  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.black, self.white, self.black_slope, self.contrast_slope, self.blur_u_px2, self.blur_v_px2);
  }
};

/// A known template, laid over a picture so that it fits best.
struct Registration {
  /// Tag coordinates (x, y, 1) to the undistorted image plane Z = 1 (homogeneous).
  /// Of a bent sheet: of the plane that touches it in the middle of the tag.
  Eigen::Matrix3d nHt = Eigen::Matrix3d::Identity();
  /// Curvatures of the sheet, xx, xy and yy, in half sides of the tag over the radius; zero for a flat one.
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  /// A shadow or a reflection on the tag, if there is one. The levels of `appearance` are those with its mean share.
  std::optional<UnevenLight> light;
  /// Of the square, in the picture as it is; AprilTag's order. Of a bent sheet: where they were if it were flat.
  std::array<Eigen::Vector2d, 4> corners_px;
  Matrix8d covariance_px2 = Matrix8d::Zero();  ///< of (u0, v0, u1, v1, ...), from the measured noise
  Appearance appearance;                       ///< gray levels and blur
  double cell_px = 0.0;                        ///< shorter side of a cell
  double residual_rms = 0.0;                   ///< RMS of what the template does not explain, in gray levels
  double outlier_share = 0.0;  ///< of the pixels used, those that something else explains (an occlusion, a reflection)
  int pixels = 0;              ///< how many were used
};

/// The entry point: fits the whole template - outer and inner edges at once - to the full-resolution picture, starting
/// from `nHt`, whose corners may be off by about a third of a cell; nothing if it does not converge or if it leaves
/// the picture. The result has not been read yet: see read_tag(). Never throws, never allocates.
std::optional<Registration> register_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                                         const Eigen::Matrix3d& nHt, const Appearance& start) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
