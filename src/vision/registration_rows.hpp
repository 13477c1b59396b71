#pragma once

#include <Eigen/Core>

#include "template_samples.hpp"

namespace pilotfish::vision {

inline constexpr int kFlatParameters = 16;                     ///< of a flat tag in even light
inline constexpr int kBentParameters = kFlatParameters + 3;    ///< of a tag on a bent sheet
inline constexpr int kShadedParameters = kFlatParameters + 5;  ///< of a tag with a shadow or a reflection on it
inline constexpr int kLightParameters = kShadedParameters - kFlatParameters;
inline constexpr int kMostParameters = kShadedParameters;
/// Their order, behind the eight of the homography. A bend and uneven light are never fitted together.
enum Parameter : int { kB = 8, kC, kBx, kBy, kCx, kCy, kBlurU, kBlurV, kBend, kLight = kBend };

/// J and r, a row a sample; zero where a sample is not used. Single precision suffices: it affects the steps, but not
/// the solution, where J^T r is zero.
struct Rows {
  Eigen::Matrix<float, TemplateSamples::kCapacity, kMostParameters> J;
  Eigen::Matrix<float, TemplateSamples::kCapacity, 1> r;
};

}  // namespace pilotfish::vision
