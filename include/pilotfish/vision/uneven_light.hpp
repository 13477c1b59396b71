#pragma once

#include <Eigen/Core>
#include <array>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Light that is not even over a sheet, in five numbers: how far the gray levels of black and of white differ where it
/// has its full share, and where it has which share. With s in tag coordinates:
///
///   edge   what a door frame or a table leaves of the sun: a straight edge with its penumbra,
///          share = Phi((n . s - place[1]) / place[2]),   n = (cos place[0], sin place[0])
///   spot   what a lamp leaves on a sheet that shines: share = exp(-|s - (place[0], place[1])|^2 / (2 place[2]^2))
struct UnevenLight {
  /// What it looks like.
  enum class Shape {
    edge,  ///< of a shadow
    spot,  ///< a reflection
  };

  Shape shape = Shape::edge;      ///< which of the two
  double black_step = 0.0;        ///< of black [gray levels]
  double contrast_step = 0.0;     ///< of white over black [gray levels]
  std::array<double, 3> place{};  ///< see above

  double share_at(const Eigen::Vector2d& tag) const;  ///< tag: in tag coordinates
  double mean_share() const;                          ///< over the tag
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
