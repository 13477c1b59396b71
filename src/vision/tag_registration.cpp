#include "pilotfish/vision/tag_registration.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "corner_covariance.hpp"
#include "linearize.hpp"
#include "registration_task.hpp"
#include "tag_warp.hpp"
#include "template_samples.hpp"

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
constexpr double kMaxResidual_contrasts = 0.05;  ///< a fit on the wrong edges has a larger residual, in contrasts,
constexpr double kMaxOutlierShare = 0.1;         ///< or more outliers among its samples
constexpr double kMinNoise = 0.2;         ///< gray levels: even a perfect picture is rounded, and a sample is a mean
constexpr double kNotConverged_px = 0.1;  ///< a last step of this length or more: it has not converged
constexpr int kCoarseSamples = 150, kFineSamples = 300, kManySamples = 700;
constexpr double kLargeCell_px = 20.0;  ///< larger ones have room for many samples, each with noise of its own
constexpr double kShapeError_px = 0.2;  ///< see shape_sigma_px
constexpr int kManySteps = 10;          ///< a fit with local levels or a bend starts from ones that are rough
constexpr double kLitFrom_px = 5.0;   ///< below, a hard shadow was fitted as an edge of the tag: 9 of 32 headings wrong
constexpr double kLightReach = 0.6;   ///< cells: a cell's own gray counts four times as much as its neighbour's
constexpr double kLitBetter = 0.8;    ///< a fit with local levels must leave less than this of the residual
constexpr double kBentBetter = 0.8;   ///< the same of a bent sheet
constexpr double kBentFrom_px = 2.0;  ///< a side of a cell; below, a bend cannot be seen
constexpr double kLikelyBend = 0.25, kLargestBend = 0.6;     ///< half the tag's side over the radius
constexpr double kShadedBetter = 0.8, kShadedFrom_px = 2.0;  ///< the same of uneven light
constexpr double kLightStep = 0.5;                           ///< of the place of uneven light, that is likely
constexpr double kUselessResidual_contrasts = 0.12;
constexpr double kInnerBetter = 0.8;  ///< the same without the outer edges
constexpr double kAgree = 2.0;  ///< residuals that move the tag so many times as much as independent ones are none

/// Side of a cell in pixels, along the axis of the tag that looks shorter.
double smallest_cell_px(const TagWarp& warp, const TagPattern& pattern) {
  const Eigen::Matrix2d J = warp.flat_jacobian(Eigen::Vector2d::Zero());
  return pattern.cell_side * std::min(J.col(0).norm(), J.col(1).norm());
}

/// The mean grays of the white and the black cells' middles.
bool measure_levels(const ImageView& image, const CameraModel& camera, const TagPattern& pattern, Fit& fit) {
  double sum[2] = {0.0, 0.0};
  int count[2] = {0, 0};
  for (const TagPattern::Cell& cell : pattern.known) {
    const Eigen::Vector2d pixel = fit.warp.pixel(camera, fit.warp.flat(cell.centre));
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < image.width - 0.5 && pixel.y() < image.height - 0.5))
      continue;
    const Eigen::Vector2d from_rim = pixel + Eigen::Vector2d(0.5, 0.5);
    const auto u = static_cast<std::ptrdiff_t>(from_rim.x()), v = static_cast<std::ptrdiff_t>(from_rim.y());
    sum[cell.white] += image.data[v * image.stride_bytes + u];
    ++count[cell.white];
  }
  if (count[0] == 0 || count[1] == 0) return false;
  fit.appearance.black = sum[0] / count[0];
  fit.appearance.white = sum[1] / count[1];
  return fit.appearance.contrast() > 0.0;
}

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
  if (model == Model::shaded) fit.light = fit.light->moved(step.segment<kLightParameters>(kLight));
  fit.appearance.black += step[kB];
  fit.appearance.white += step[kB] + step[kC];
  fit.appearance.black_slope += step.segment<2>(kBx);
  fit.appearance.contrast_slope += step.segment<2>(kCx);
  if (!with_blur) return;
  fit.appearance.blur_u_px2 = std::clamp(fit.appearance.blur_u_px2 + step[kBlurU], kSmallestBlur_px2, kLargestBlur_px2);
  fit.appearance.blur_v_px2 = std::clamp(fit.appearance.blur_v_px2 + step[kBlurV], kSmallestBlur_px2, kLargestBlur_px2);
}

double largest_move(const TagWarp& before, const TagWarp& after) {
  double largest = 0.0;
  for (const Eigen::Vector2d& corner : tag_corners())
    largest = std::max(largest, (after.flat(corner) - before.flat(corner)).norm());
  return largest;
}

/// What is left of the blur's shape, which is not quite Gaussian, pulls all pixels of an edge the same way; the smaller
/// the cells, the less the edges' two flanks cancel. [px], of one corner coordinate, from renders of known geometry.
double shape_sigma_px(const Appearance& appearance, double cell_px) {
  const double blur_cells2 = 0.5 * (appearance.blur_u_px2 + appearance.blur_v_px2) / (cell_px * cell_px);
  return kShapeError_px * std::min(blur_cells2, 1.0);
}

/// The step to the minimum of the first N parameters; the others stay.
template <int N>
Parameters solved(const NormalEquations& sum) {
  Eigen::Matrix<double, N, 1> scale;
  const Eigen::LDLT<NormalOf<N>> solver = scaled<N>(sum.information, scale);
  Parameters step = Parameters::Zero();
  step.head<N>() = scale.cwiseProduct(solver.solve(scale.cwiseProduct(sum.gradient.head<N>())));
  return step;
}

/// One Gauss-Newton step; how far it moved the corners [px], or NaN. `extra_blur_px2` is what the samples are blurred
/// with beyond the picture's own blur, which only a `fine` step changes.
double step_once(Task& task, double extra_blur_px2, bool fine, Fit& fit) {
  const double blur_u = fit.appearance.blur_u_px2 + extra_blur_px2, blur_v = fit.appearance.blur_v_px2 + extra_blur_px2;
  NormalEquations& sum = task.sum;
  const auto passed = [&](const auto& pass) {
    return pass(fit, task.pattern, task.samples, blur_u, blur_v, task.rows);
  };
  const bool near = task.samples.reach == 1;
  if (task.model == Model::bent)
    sum = near ? passed(linearize<1, Model::bent>) : passed(linearize<2, Model::bent>);
  else if (task.model == Model::shaded)
    sum = near ? passed(linearize<1, Model::shaded>) : passed(linearize<2, Model::shaded>);
  else if (task.model == Model::lit)
    sum = near ? passed(linearize<1, Model::lit>) : passed(linearize<2, Model::lit>);
  else
    sum = near ? passed(linearize<1, Model::even>) : passed(linearize<2, Model::even>);
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
  const Parameters step = task.model == Model::bent     ? solved<kBentParameters>(sum)
                          : task.model == Model::shaded ? solved<kShadedParameters>(sum)
                                                        : solved<kFlatParameters>(sum);
  if (!step.allFinite()) return std::nan("");
  const TagWarp before = fit.warp;
  apply(step, fine, task.model, fit);
  return largest_move(before, fit.warp);
}

/// From far away: a template blurred by a third of a cell converges from a third of a cell away. False if it does not.
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

/// From near by, with the picture's own blur. Unless it was `pulled_in` already, a step on few samples goes ahead, so
/// that the many lie evenly about the edges. False if it does not converge.
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
  for (int i = 0; i < (task.model == Model::even || task.model == Model::inside ? 6 : kManySteps); ++i) {
    move_px = step_once(task, extra_blur, true, fit);
    if (!(move_px < task.cell_px)) return false;
    if (move_px < kConverged_px) return true;
  }
  return move_px < kNotConverged_px;
}

double unexplained(const Fit& fit) { return fit.noise * (1.0 + fit.outlier_share); }

/// The same in uneven light: a shadow's edge, a reflection. Only where cells are large enough for their middles to show
/// their levels, and for an edge of light to lie apart from theirs. False if it does not converge, or explains the
/// picture hardly better than `plain`, if that is a fit.
bool settle_lit(Task& task, LevelField& light, const Fit* plain, Fit& fit) {
  if (task.cell_px < kLitFrom_px || !light.measure(task.image, task.camera, fit.warp, task.pattern, kLightReach, false))
    return false;
  const Appearance levels = fit.appearance;
  // From here on the levels are what is added to those of the light.
  fit.appearance.black = fit.appearance.white = 0.0;
  fit.appearance.black_slope.setZero();
  fit.appearance.contrast_slope.setZero();
  task.model = Model::lit;
  task.samples.light = &light;
  const bool settled = settle(task, true, fit);
  task.samples.light = nullptr;
  task.model = Model::even;
  fit.appearance.black += levels.black;
  fit.appearance.white += levels.white;
  fit.appearance.black_slope += levels.black_slope;
  fit.appearance.contrast_slope += levels.contrast_slope;
  if (!settled) return false;
  return plain == nullptr || unexplained(fit) < kLitBetter * unexplained(*plain);
}

/// The same for a sheet that is bent, from `plain` or, if that is none, from `fit` as it is. False if it does not
/// converge or explains the picture hardly better.
bool settle_bent(Task& task, const Fit* plain, Fit& fit) {
  if (task.cell_px < kBentFrom_px) return false;
  task.model = Model::bent;
  fit.warp.aim_normal();
  const Fit start = fit;
  bool settled = (plain != nullptr || fit.warp.is_bent()) && settle(task, true, fit);
  if (!settled) {
    fit = start;
    settled = pull_in(task, fit) && settle(task, true, fit);
  }
  task.model = Model::even;
  return settled && (plain == nullptr || unexplained(fit) < kBentBetter * unexplained(*plain));
}

/// The same without the outer edges: on a print that is cut close to them something dark lies where white is expected.
/// Pixel by pixel the inner edges are few, and worth less than a dark rim costs until the fit is of no use with it.
bool settle_inside(Task& task, const Fit* plain, Fit& fit) {
  if (plain != nullptr && task.cell_px < kDenseBelow_px &&
      plain->noise < kUselessResidual_contrasts * plain->appearance.contrast())
    return false;
  task.samples.inner_only = true;
  const bool settled = settle(task, plain != nullptr, fit) || (pull_in(task, fit) && settle(task, true, fit));
  task.samples.inner_only = false;
  return settled && (plain == nullptr || unexplained(fit) < kInnerBetter * unexplained(*plain));
}

/// The same in light of a simple shape, from about where it is.
bool settle_shaded(Task& task, const std::optional<UnevenLight>& light, const Fit* plain, Fit& fit) {
  if (!fit.light) fit.light = light;
  if (!fit.light || task.cell_px < kShadedFrom_px) return false;
  task.model = Model::shaded;
  const bool settled = settle(task, true, fit);
  task.model = Model::even;
  return settled && (plain == nullptr || unexplained(fit) < kShadedBetter * unexplained(*plain));
}

/// Whether a fit converged to the tag and not to some other edge: then it explains the picture well.
bool explains(const Fit& fit) {
  return fit.noise < kMaxResidual_contrasts * fit.mean_appearance().contrast() && fit.outlier_share < kMaxOutlierShare;
}

/// What may explain a picture that a flat, evenly lit tag with a white ring does not.
enum class Cause { shadow, reflection, bend, close_cut, light };

/// Tries `causes` from `start` and takes the one that leaves the least of the picture unexplained, if there is one that
/// is better than `plain`. `task`, which holds the normal equations of `plain`, then holds those of the result.
bool settle_best(std::initializer_list<Cause> causes, Task& task, const Fit* plain, const Fit& start, Fit& fit) {
  LevelField field;
  const std::optional<UnevenLight> shadow = find_uneven_light(UnevenLight::Shape::edge, task.rows, task.samples.count),
                                   spot = find_uneven_light(UnevenLight::Shape::spot, task.rows, task.samples.count);
  const auto settle_as = [&](Cause cause, const Fit* than, Fit& each) {
    switch (cause) {
      case Cause::shadow: return settle_shaded(task, shadow, than, each) && explains(each);
      case Cause::reflection: return settle_shaded(task, spot, than, each) && explains(each);
      case Cause::bend: return settle_bent(task, than, each) && explains(each);
      case Cause::close_cut: return settle_inside(task, than, each) && explains(each);
      default: return settle_lit(task, field, than, each);
    }
  };
  const Fit from = start;
  const Fit flat = plain != nullptr ? *plain : start;
  std::optional<Cause> best;
  for (Cause cause : causes) {
    Fit each = from;
    if (!settle_as(cause, plain != nullptr ? &flat : nullptr, each)) continue;
    if (best && unexplained(each) >= unexplained(fit)) continue;
    fit = each;
    best = cause;
  }
  if (!best) return false;
  if (*best == *(causes.end() - 1)) return true;
  Fit again = fit;
  if (!settle_as(*best, nullptr, again)) return false;
  fit = again;
  return true;
}

}  // namespace

std::optional<Registration> register_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                                         const Eigen::Matrix3d& nHt, const Appearance& start) noexcept {
  Fit fit{TagWarp(camera, nHt), start, 0.0, 0.0, std::nullopt};
  fit.appearance.black_slope.setZero();  // uneven light is measured anew
  fit.appearance.contrast_slope.setZero();
  if (!fit.warp.is_finite() || !measure_levels(image, camera, pattern, fit)) return std::nullopt;
  const double cell_px = smallest_cell_px(fit.warp, pattern);
  if (!(cell_px > 0.5)) return std::nullopt;

  Task task{image, camera, pattern, start, cell_px, {}, {}, {}};
  Fit near = fit;
  if (!settle(task, false, near) || !explains(near)) {
    near = fit;
    const bool settled = pull_in(task, near) && settle(task, true, near);
    if (!settled || !explains(near)) {
      const Fit* plain = settled ? &near : nullptr;
      const Fit from = settled ? near : fit;
      Fit anew = fit;
      if (settle_best({Cause::shadow, Cause::reflection, Cause::bend, Cause::close_cut, Cause::light}, task, plain,
                      from, near)) {
      } else if (settled && settle_bent(task, nullptr, anew) && explains(anew)) {
        near = anew;
      } else if (!settled || !settle(task, true, near)) {  // once more, for its normal equations
        return std::nullopt;
      }
    }
  }
  if (!(largest_move(fit.warp, near.warp) < 2.0 * cell_px)) return std::nullopt;
  CornerCovariance covariance = corner_covariance(camera, near, task);
  // What moves all of its parts one way is no noise: a bend, or something dark beside the outer edges.
  if (covariance.agreement > kAgree && !near.warp.is_bent() && !near.light) {
    const Fit plain = near;
    if (settle_best({Cause::shadow, Cause::reflection, Cause::bend}, task, &plain, plain, near))
      covariance = corner_covariance(camera, near, task);
  }
  fit = near;
  fit.appearance = fit.mean_appearance();

  Registration found;
  found.nHt = fit.warp.nHt();
  found.bend = fit.warp.bend;
  found.corners_px = tag_corners_px(camera, fit.warp.tangent());
  found.covariance_px2 = covariance.px2;
  const double shape_px = shape_sigma_px(fit.appearance, cell_px);
  found.covariance_px2.diagonal().array() += shape_px * shape_px;
  found.appearance = fit.appearance;
  found.cell_px = smallest_cell_px(fit.warp, pattern);
  found.residual_rms = fit.noise;
  found.outlier_share = fit.outlier_share;
  found.pixels = task.sum.inliers;
  if (!found.covariance_px2.allFinite() || !found.nHt.allFinite()) return std::nullopt;
  return found;
}

}  // namespace pilotfish::vision
