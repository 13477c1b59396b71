#include "explanations.hpp"

#include <cmath>

#include "template_fit.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kMaxResidual_contrasts = 0.05;  ///< a fit on the wrong edges has a larger residual, in contrasts,
constexpr double kMaxOutlierShare = 0.1;         ///< or more outliers among its samples
constexpr double kLitFrom_px = 5.0;   ///< below, a hard shadow was fitted as an edge of the tag: 9 of 32 headings wrong
constexpr double kLightReach = 0.6;   ///< cells: a cell's own gray counts four times as much as its neighbour's
constexpr double kLitBetter = 0.8;    ///< a fit with local levels must leave less than this of the residual
constexpr double kWorthwhile = 30.0;  ///< of the likelihood ratio, see explains_more()
constexpr double kBentFrom_px = 2.0;  ///< a side of a cell; below, a bend cannot be seen
constexpr double kShadedFrom_px = 2.0;  ///< a side of a cell; below, light cannot be told from bits
constexpr double kUselessResidual_contrasts = 0.12;
constexpr double kClearlyBetter = 0.95;
constexpr double kInnerBetter = 0.8;  ///< the same without the outer edges

double unexplained(const Fit& fit) { return fit.noise * (1.0 + fit.outlier_share); }

/// Whether more parameters are worth it, by the likelihood ratio n ln(s0^2 / s1^2). Without need it has the
/// distribution of chi-squared with as many degrees of freedom as there are more; neighbouring samples are not quite
/// independent, so more is asked for.
bool explains_more(const Fit& fit, const Fit& plain, const Task& task) {
  return 2.0 * task.sum.inliers * std::log(unexplained(plain) / unexplained(fit)) > kWorthwhile;
}

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

/// The same in light of a simple shape, from about where it is, and from two places of the tag: that of `fit`, and that
/// where it was expected, from which uneven light has not drawn it away.
bool settle_shaded(Task& task, const std::optional<UnevenLight>& light, const TagWarp& expected, const Fit* plain,
                   Fit& fit) {
  if (!fit.light) fit.light = light;
  if (!fit.light || task.cell_px < kShadedFrom_px) return false;
  task.model = Model::shaded;
  Fit other = fit;
  other.warp = expected;
  const bool other_settled = plain != nullptr && settle(task, true, other);
  bool settled = settle(task, true, fit);
  if (other_settled && (!settled || unexplained(other) < kClearlyBetter * unexplained(fit))) {
    fit = other;
    settled = settle(task, true, fit);  // once more, for its normal equations
  }
  task.model = Model::even;
  return settled && (plain == nullptr || explains_more(fit, *plain, task));
}

}  // namespace

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
  return settled && (plain == nullptr || explains_more(fit, *plain, task));
}

bool may_be_bent(Task& task, const Fit& flat) {
  if (task.cell_px < kBentFrom_px) return false;
  Fit start = flat;
  start.warp.aim_normal();
  task.model = Model::bent;
  const NormalEquations sum = linearized(task, start, task.cell_px < kDenseBelow_px ? 0.0 : kSampleBlur_px2);
  const double fall = sum.gradient.dot(solved(task.model, sum));
  task.model = Model::even;
  return fall > kWorthwhile * flat.noise * flat.noise;
}

bool explains(const Fit& fit) {
  return fit.noise < kMaxResidual_contrasts * fit.mean_appearance().contrast() && fit.outlier_share < kMaxOutlierShare;
}

bool settle_best(std::initializer_list<Cause> causes, Task& task, const TagWarp& expected, const Fit* plain,
                 const Fit& start, Fit& fit) {
  LevelField field;
  // Before the first trial takes samples of its own.
  std::optional<UnevenLight> shadow, reflection;
  for (Cause cause : causes) {
    if (cause == Cause::shadow) shadow = find_uneven_light(UnevenLight::Shape::edge, task.rows, task.samples.count);
    if (cause == Cause::reflection)
      reflection = find_uneven_light(UnevenLight::Shape::spot, task.rows, task.samples.count);
  }
  const auto settle_as = [&](Cause cause, const Fit* than, Fit& each) {
    switch (cause) {
      case Cause::shadow: return settle_shaded(task, shadow, expected, than, each) && explains(each);
      case Cause::reflection: return settle_shaded(task, reflection, expected, than, each) && explains(each);
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

}  // namespace pilotfish::vision
