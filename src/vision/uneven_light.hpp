#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "registration_rows.hpp"
#include "template_samples.hpp"

namespace pilotfish::vision {

/// Light that is not even over a sheet, in five numbers: how far the gray levels of black and of white differ where it
/// has its full share, and where it has which share. With s in tag coordinates:
///
///   edge   what a door frame or a table leaves of the sun: a straight edge with its penumbra,
///          share = Phi((n . s - place[1]) / place[2]),   n = (cos place[0], sin place[0])
///   spot   what a lamp leaves on a sheet that shines: share = exp(-|s - (place[0], place[1])|^2 / (2 place[2]^2))
///
/// Where white paper is, light may be more than the camera can show: see kClipped.
struct UnevenLight {
  enum class Shape { edge, spot };

  Shape shape = Shape::edge;
  double black_step = 0.0, contrast_step = 0.0;  ///< of the gray levels
  Eigen::Vector3d place = Eigen::Vector3d::Zero();

  double mean_share() const;  ///< over the tag

  /// The same with steps and place changed by those, which are kept small.
  UnevenLight moved(const Eigen::Matrix<double, kLightParameters, 1>& step) const;
};

/// Gray levels from which on a sample may be of light that the camera could not show.
inline constexpr float kClipped = 250.0F;

/// The light of that shape that explains most of what a fit in even light left in the first `count` of its `rows`, if
/// it is worth while.
std::optional<UnevenLight> find_uneven_light(UnevenLight::Shape shape, const Rows& rows, int count);

/// The share of the light at eight samples, and its derivatives with respect to its place.
struct LightLanes {
  Lanes share;
  std::array<Lanes, 3> d_place;

  LightLanes() = default;
  LightLanes(const UnevenLight& light, const Lanes& x, const Lanes& y);
};

}  // namespace pilotfish::vision
