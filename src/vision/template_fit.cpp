#include "template_fit.hpp"

#include <algorithm>
#include <cmath>

#include "linearize.hpp"

// The picture of a template is known up to where it lies (eight parameters h of a homography), how bright black and
// white are (their level and slope over the tag) and how far it is blurred (along rows and columns: a turning camera
// smears sideways). At a pixel p that shows the point s of the tag, with T the blurred template,
//
//   I(p) = B(s) + C(s) T(s; v),    B(s) = B + Bx x + By y,    C(s) = C + Cx x + Cy y,
//   v = diagonal of G diag(bu, bv) G^T,   G = ds/dp  (the blur, carried to the tag)
//
// and with white noise the most likely parameters are those of least squares: Gauss-Newton over pixels that lie on
// edges (Baker and Matthews, "Lucas-Kanade 20 years on", 2004, for the scheme; here the template is a formula, so that
// its blur can follow the picture's). When h moves the tag, s at the fixed pixel moves the other way:
//
//   dI/dh = -(dI/ds) (dg/ds)^-1 dg/dh.
//
// All edges, outer and inner, are fitted in one; that is also why a bright tag that bleeds into its dark cells does not
// look larger: it bleeds inwards at the outer edge of the black frame and outwards at its inner one.

namespace pilotfish::vision {
namespace {

constexpr double kSmallestBlur_px2 = 0.05, kLargestBlur_px2 = 36.0;
constexpr double kSpread = 1.3;         ///< samples lie so many standard deviations of the blur beside an edge, at most
constexpr double kConverged_px = 0.03;  ///< after a smaller step the rest is a hundredth of it
constexpr double kNear_px = 0.7;        ///< a longer first step started too far away for its direction to be reliable
constexpr double kMinNoise = 0.2;       ///< gray levels: even a perfect picture is rounded, and a sample is a mean
constexpr double kNotConverged_px = 0.1;  ///< a last step of this length or more: it has not converged
constexpr int kCoarseSamples = 150, kFineSamples = 300, kManySamples = 700;
constexpr double kLargeCell_px = 20.0;  ///< larger ones have room for many samples, each with noise of its own
constexpr int kManySteps = 10;  ///< a fit with local levels, a reflection or a bend starts from ones that are rough
constexpr double kLikelyBend = 0.25, kLargestBend = 0.6;  ///< half the tag's side over the radius
constexpr double kLightStep = 0.5;                        ///< of the place of uneven light, that is likely

/// Prior knowledge: paper is lit evenly to some 20 % of its contrast, and a camera's blur stays what
/// it was to 1 px^2. Without it the pixels of a very small tag could not determine 16 numbers. A sheet that is bent
/// more than to four times the tag's half side is rare.
void add_prior(const Fit& fit, const Appearance& start, Model model, double noise, NormalEquations& sum) {
  const double slope_weight = std::pow(noise / (0.2 * std::max(fit.appearance.contrast(), 1.0)), 2);
  const Eigen::Vector4d slopes = fit.slopes();
  for (int i = 0; i < 4; ++i) {
    sum.information(kBx + i, kBx + i) += slope_weight;
    sum.gradient[kBx + i] -= slope_weight * slopes[i];
  }
  const double blur_weight = noise * noise;
  sum.information(kBlurU, kBlurU) += blur_weight;
  sum.information(kBlurV, kBlurV) += blur_weight;
  sum.gradient[kBlurU] -= blur_weight * (fit.appearance.blur_u_px2 - start.blur_u_px2);
  sum.gradient[kBlurV] -= blur_weight * (fit.appearance.blur_v_px2 - start.blur_v_px2);
  if (model == Model::bent) {
    const double weight = std::pow(noise / kLikelyBend, 2);
    for (int i = 0; i < 3; ++i) {
      sum.information(kBend + i, kBend + i) += weight;
      sum.gradient[kBend + i] -= weight * fit.warp.bend[i];
    }
  }
  // Where faint light ends is not known; the steps towards it are kept small.
  if (model == Model::shaded)
    for (int i = kLight + 2; i < kShadedParameters; ++i) sum.information(i, i) += std::pow(noise / kLightStep, 2);
}

void apply(const Parameters& step, bool with_blur, Model model, Fit& fit) {
  fit.warp.h += step.head<8>();
  if (model == Model::bent) {
    fit.warp.bend = (fit.warp.bend + step.segment<3>(kBend)).cwiseMax(-kLargestBend).cwiseMin(kLargestBend);
    fit.warp.aim_normal();
  }
  if (model == Model::shaded) fit.light = moved(*fit.light, step.segment<kLightParameters>(kLight));
  fit.appearance.black += step[kB];
  fit.appearance.white += step[kB] + step[kC];
  fit.appearance.black_slope += step.segment<2>(kBx);
  fit.appearance.contrast_slope += step.segment<2>(kCx);
  if (!with_blur) return;
  fit.appearance.blur_u_px2 = std::clamp(fit.appearance.blur_u_px2 + step[kBlurU], kSmallestBlur_px2, kLargestBlur_px2);
  fit.appearance.blur_v_px2 = std::clamp(fit.appearance.blur_v_px2 + step[kBlurV], kSmallestBlur_px2, kLargestBlur_px2);
}

/// The step to the minimum of the first N parameters; the others stay.
template <int N>
Parameters solved_first(const NormalEquations& sum) {
  Eigen::Matrix<double, N, 1> scale;
  const Eigen::LDLT<NormalOf<N>> solver = scaled<N>(sum.information, scale);
  Parameters step = Parameters::Zero();
  step.head<N>() = scale.cwiseProduct(solver.solve(scale.cwiseProduct(sum.gradient.head<N>())));
  return step;
}

/// One Gauss-Newton step; how far it moved the corners [px], or NaN. `extra_blur_px2` is what the samples are blurred
/// with beyond the picture's own blur, which only a `fine` step changes.
double step_once(Task& task, double extra_blur_px2, bool fine, Fit& fit) {
  NormalEquations& sum = task.sum;
  sum = linearized(task, fit, extra_blur_px2);
  const int parameters = parameters_of(task.model);
  if (sum.inliers < 2 * parameters) return std::nan("");
  fit.noise = std::max(kMinNoise, std::sqrt(sum.squared_error / (sum.inliers - parameters)));
  fit.outlier_share = 1.0 - static_cast<double>(sum.inliers) / std::max(task.samples.count - sum.clipped, 1);
  add_prior(fit, task.expected, task.model, fit.noise, sum);
  if (!fine)
    for (int i : {kBlurU, kBlurV}) {
      sum.information.row(i).setZero();
      sum.information.col(i).setZero();
      sum.information(i, i) = 1.0;
      sum.gradient[i] = 0.0;
    }
  const Parameters step = solved(task.model, sum);
  if (!step.allFinite()) return std::nan("");
  const TagWarp before = fit.warp;
  apply(step, fine, task.model, fit);
  return largest_move(before, fit.warp);
}

}  // namespace

Parameters solved(Model model, const NormalEquations& sum) {
  if (model == Model::bent) return solved_first<kBentParameters>(sum);
  if (model == Model::shaded) return solved_first<kShadedParameters>(sum);
  return solved_first<kFlatParameters>(sum);
}

NormalEquations linearized(Task& task, const Fit& fit, double extra_blur_px2) {
  const double blur_u = fit.appearance.blur_u_px2 + extra_blur_px2, blur_v = fit.appearance.blur_v_px2 + extra_blur_px2;
  const auto passed = [&](const auto& near, const auto& far) {
    const auto& pass = task.samples.reach == 1 ? near : far;
    return pass(fit, task.pattern, task.samples, blur_u, blur_v, task.rows);
  };
  switch (task.model) {
    case Model::bent: return passed(linearize<1, Model::bent>, linearize<2, Model::bent>);
    case Model::shaded: return passed(linearize<1, Model::shaded>, linearize<2, Model::shaded>);
    case Model::lit: return passed(linearize<1, Model::lit>, linearize<2, Model::lit>);
    default: return passed(linearize<1, Model::even>, linearize<2, Model::even>);
  }
}

double largest_move(const TagWarp& before, const TagWarp& after) {
  double largest = 0.0;
  for (const Eigen::Vector2d& corner : tag_corners())
    largest = std::max(largest, (after.flat(corner) - before.flat(corner)).norm());
  return largest;
}

bool pull_in(Task& task, Fit& fit) {
  const double wide_px = 0.3 * task.cell_px;
  const double extra_blur = wide_px * wide_px - std::min(fit.appearance.blur_u_px2, fit.appearance.blur_v_px2);
  if (extra_blur <= kSampleBlur_px2) return true;  // the picture's own blur has the same range
  task.samples.reach = 1;
  take_along_edges(task.image, task.camera, fit.warp, task.pattern, wide_px, kCoarseSamples, task.samples);
  for (int i = 0; i < 4; ++i) {
    const double move_px = step_once(task, extra_blur, false, fit);
    if (!(move_px < task.cell_px)) return false;
    if (move_px < 0.3 * kNear_px) break;
  }
  fit.noise = 0.0;
  return true;
}

bool settle(Task& task, bool pulled_in, Fit& fit) {
  const bool dense = task.cell_px < kDenseBelow_px;
  const double extra_blur = dense ? 0.0 : kSampleBlur_px2;
  const double widest_px = std::sqrt(std::max(fit.appearance.blur_u_px2, fit.appearance.blur_v_px2) + kSampleBlur_px2);
  task.samples.reach = widest_px < 0.4 * task.cell_px ? 1 : 2;
  const auto take = [&](int wanted) {
    if (dense)
      take_pixels(task.image, task.camera, fit.warp, task.pattern, task.samples);
    else
      take_along_edges(task.image, task.camera, fit.warp, task.pattern, kSpread * widest_px, wanted, task.samples);
  };
  if (!pulled_in && !dense) {
    take(kCoarseSamples);
    if (!(step_once(task, extra_blur, true, fit) < kNear_px)) return false;
  }
  take(task.cell_px > kLargeCell_px ? kManySamples : kFineSamples);
  fit.noise = 0.0;
  double move_px = 0.0;
  for (int i = 0; i < (task.model == Model::even ? 6 : kManySteps); ++i) {
    move_px = step_once(task, extra_blur, true, fit);
    if (!(move_px < task.cell_px)) return false;
    if (move_px < kConverged_px) return true;
  }
  return move_px < kNotConverged_px;
}

}  // namespace pilotfish::vision
