#pragma once

#include <Eigen/Cholesky>

#include "pilotfish/vision/tag_registration.hpp"
#include "tag_warp.hpp"
#include "template_samples.hpp"

// What the parts of one fit of a template share; tag_registration.cpp says what is fitted.

namespace pilotfish::vision {

inline constexpr int kFlatParameters = 16;                   ///< of a flat tag
inline constexpr int kBentParameters = kFlatParameters + 3;  ///< of a tag on a bent sheet
enum Parameter : int { kB = 8, kC, kBx, kBy, kCx, kCy, kBlurU, kBlurV, kBend };
template <int N>
using NormalOf = Eigen::Matrix<double, N, N>;
using Normal = NormalOf<kBentParameters>;
using Parameters = Eigen::Matrix<double, kBentParameters, 1>;

struct Fit {
  TagWarp warp;
  Appearance appearance;
  double noise = 0.0;  ///< gray levels, 0: not known yet
  double outlier_share = 0.0;

  Eigen::Vector4d slopes() const {
    Eigen::Vector4d all;
    all << appearance.black_slope, appearance.contrast_slope;
    return all;
  }
};

/// The least-squares problem at one point: J^T J, J^T r and r^T r over the pixels that are accepted. Of a flat tag only
/// the first kFlatParameters rows and columns are used.
struct NormalEquations {
  Normal information = Normal::Zero();
  Parameters gradient = Parameters::Zero();
  double squared_error = 0.0;
  int inliers = 0;
};

/// J and r, a row a sample. Single precision suffices: it affects the steps, but not the solution, where J^T r is zero.
struct Rows {
  Eigen::Matrix<float, TemplateSamples::kCapacity, kBentParameters> J;
  Eigen::Matrix<float, TemplateSamples::kCapacity, 1> r;
};

/// Of the first N rows and columns of the information, with a diagonal of ones: the parameters differ in size.
template <int N>
Eigen::LDLT<NormalOf<N>> scaled(const Normal& information, Eigen::Matrix<double, N, 1>& scale) {
  const auto part = information.topLeftCorner<N, N>();
  scale = part.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  return Eigen::LDLT<NormalOf<N>>(scale.asDiagonal() * part * scale.asDiagonal());
}

/// Input and scratch memory of one fit; some 100 kB, on the stack of register_tag().
struct Task {
  const ImageView& image;
  const CameraModel& camera;
  const TagPattern& pattern;
  const Appearance& expected;
  double cell_px;
  TemplateSamples samples;
  Rows rows;
  NormalEquations sum;
  bool bent = false;  ///< whether the sheet's curvatures are fitted
};

}  // namespace pilotfish::vision
