#pragma once

#include <array>
#include <optional>

#include "pilotfish/vision/uneven_light.hpp"
#include "registration_rows.hpp"
#include "template_samples.hpp"

namespace pilotfish::vision {

/// The same light with steps and place changed by `step`, which is kept small.
UnevenLight moved(const UnevenLight& light, const Eigen::Matrix<double, kLightParameters, 1>& step);

/// Gray levels from which on a sample may be of light that the camera could not show.
inline constexpr float kClipped = 250.0F;

/// Where light may end or lie, and how much of what a fit left is explained by that, 0 to 1.
struct FoundLight {
  UnevenLight light;
  double explained = 0.0;
};

/// The light of that shape that explains most of what a fit in even light left in the first `count` of its `rows`, if
/// it is worth while.
std::optional<FoundLight> find_uneven_light(UnevenLight::Shape shape, const Rows& rows, int count);

/// The share of the light at eight samples, and its derivatives with respect to its place.
struct LightLanes {
  Lanes share;
  std::array<Lanes, 3> d_place;

  LightLanes() = default;
  LightLanes(const UnevenLight& light, const Lanes& x, const Lanes& y);
};

}  // namespace pilotfish::vision
