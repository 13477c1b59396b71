#pragma once

#include <Eigen/Cholesky>
#include <optional>

#include "light_search.hpp"
#include "pilotfish/vision/tag_registration.hpp"
#include "registration_rows.hpp"
#include "tag_warp.hpp"
#include "template_samples.hpp"

// What the parts of one fit of a template share; tag_registration.cpp says what is fitted.

namespace pilotfish::vision {

template <int N>
using NormalOf = Eigen::Matrix<double, N, N>;
using Normal = NormalOf<kMostParameters>;
using Parameters = Eigen::Matrix<double, kMostParameters, 1>;

/// What is fitted.
enum class Model {
  even,    ///< a flat tag with a white ring in even light
  shaded,  ///< with a shadow or a reflection on it
  lit,     ///< in light that differs from place to place
  bent,    ///< on a bent sheet
};

constexpr int parameters_of(Model model) {
  return model == Model::bent ? kBentParameters : model == Model::shaded ? kShadedParameters : kFlatParameters;
}

struct Fit {
  TagWarp warp;
  Appearance appearance;
  double noise = 0.0;  ///< gray levels, 0: not known yet
  double outlier_share = 0.0;
  std::optional<UnevenLight> light;  ///< with Model::shaded alone

  /// As if uneven light were spread over the tag.
  Appearance mean_appearance() const {
    Appearance mean = appearance;
    if (!light) return mean;
    const double share = light->mean_share();
    mean.black += share * light->black_step;
    mean.white += share * (light->black_step + light->contrast_step);
    return mean;
  }

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
  int clipped = 0;  ///< samples of light that the camera could not show
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
  Model model = Model::even;
};

}  // namespace pilotfish::vision
