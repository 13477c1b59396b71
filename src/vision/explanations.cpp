#include "explanations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "template_fit.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kMaxResidual_contrasts = 0.05;  ///< a fit on the wrong edges has a larger residual, in contrasts,
constexpr double kMaxOutlierShare = 0.1;         ///< or more outliers among its samples
constexpr double kLitFrom_px = 5.0;  ///< below, a hard shadow was fitted as an edge of the tag: 9 of 32 headings wrong
constexpr double kLightReach = 0.6;  ///< cells: a cell's own gray counts four times as much as its neighbour's
constexpr double kLitBetter = 0.8;   ///< a fit with local levels must leave less than this of the residual
constexpr std::size_t kCauses = 5;
constexpr double kLittle_contrasts = 0.028;
constexpr double kLeastContrast = 0.1;  ///< of the contrast in full light, what is left in the deepest shadow
constexpr double kWorthwhile = 30.0;    ///< of the likelihood ratio, see explains_more()
constexpr double kBentFrom_px = 2.0;    ///< a side of a cell; below, a bend cannot be seen
constexpr double kUselessResidual_contrasts = 0.12;
constexpr double kInnerBetter = 0.8;  ///< the same without the outer edges

double unexplained(const Fit& fit) { return fit.noise * (1.0 + fit.outlier_share); }

/// Whether so little is left that nothing else need be tried.
bool explains_well(const Fit& fit) { return unexplained(fit) < kLittle_contrasts * fit.mean_appearance().contrast(); }

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
  if (task.cell_px < kLitFrom_px ||
      !light.measure(task.image, task.camera, fit.warp, task.pattern, LevelField::Light::stepped, kLightReach, false))
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

/// Light leaves a contrast between black and white, unless it is more than the camera can show. What leaves none is an
/// object in front of the tag.
bool is_light(const Fit& fit) {
  const double without = fit.appearance.contrast(), with = without + fit.light->contrast_step;
  const double white = fit.appearance.white + fit.light->black_step + fit.light->contrast_step;
  const double least = std::min(without, with);
  return least > kLeastContrast * std::max(without, with) || (least == with && white >= kClipped);
}

/// The same in light of a simple shape, from about where it is, and from two places of the tag: that of `fit`, and that
/// where it was expected, from which uneven light has not drawn it away.
bool settle_shaded(Task& task, const std::optional<UnevenLight>& light, const TagWarp& expected, const Fit* plain,
                   Fit& fit) {
  if (!fit.light) fit.light = light;
  if (!fit.light) return false;
  task.model = Model::shaded;
  Fit other = fit;
  bool settled = settle(task, true, fit);
  if (plain != nullptr && !(settled && explains_well(fit))) {
    other.warp = expected;
    if (settle(task, true, other) && (!settled || unexplained(other) < unexplained(fit))) fit = other;
    settled = settle(task, true, fit);  // once more, for its normal equations
  }
  task.model = Model::even;
  return settled && is_light(fit) && (plain == nullptr || explains_more(fit, *plain, task));
}

/// By how much a bend could at most lower the sum of squares of the fit of a flat tag that `task` holds.
double fall_by_bend(Task& task, const Fit& flat) {
  if (task.cell_px < kBentFrom_px) return 0.0;
  Fit start = flat;
  start.warp.aim_normal();
  task.model = Model::bent;
  const NormalEquations sum = linearized(task, start, task.cell_px < kDenseBelow_px ? 0.0 : kSampleBlur_px2);
  task.model = Model::even;
  return sum.gradient.dot(solved(Model::bent, sum));
}

struct Likely {
  Cause cause = Cause::light;
  double explained = 0.0;  ///< share of what the plain fit left, before anything was fitted
  std::optional<UnevenLight> light;
};

bool less_likely(const Likely& a, const Likely& b) {
  return a.explained != b.explained ? a.explained < b.explained : a.cause > b.cause;
}

Likely how_likely(Cause cause, Task& task, const Fit* plain) {
  Likely likely{cause, 0.0, std::nullopt};
  const bool is_light = cause == Cause::shadow || cause == Cause::reflection;
  if (is_light && task.cell_px >= kDenseBelow_px) {  // smaller: light cannot be told from bits
    const auto shape = cause == Cause::shadow ? UnevenLight::Shape::edge : UnevenLight::Shape::spot;
    if (const std::optional<FoundLight> found = find_uneven_light(shape, task.rows, task.samples.count)) {
      likely.light = found->light;
      likely.explained = found->explained;
    }
  }
  if (cause == Cause::bend && plain != nullptr)
    likely.explained = fall_by_bend(task, *plain) / std::max(task.sum.squared_error, 1e-6);
  return likely;
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
  return fall_by_bend(task, flat) > kWorthwhile * flat.noise * flat.noise;
}

bool explains(const Fit& fit, const Task& task) {
  const double most = task.cell_px < kDenseBelow_px ? kMaxResidual_contrasts * kPixelResidual : kMaxResidual_contrasts;
  return fit.noise < most * fit.mean_appearance().contrast() && fit.outlier_share < kMaxOutlierShare;
}

bool settle_best(std::initializer_list<Cause> causes, Task& task, const TagWarp& expected, const Fit* plain,
                 const Fit& start, Fit& fit) {
  LevelField field;
  const Fit from = start;
  const Fit flat = plain != nullptr ? *plain : start;
  // Before the first trial takes samples of its own.
  std::array<Likely, kCauses> likely;
  const auto end = std::transform(causes.begin(), causes.end(), likely.begin(), [&](Cause cause) {
    return how_likely(cause, task, plain != nullptr ? &flat : nullptr);
  });
  const auto settle_as = [&](const Likely& each, const Fit* than, Fit& trial) {
    switch (each.cause) {
      case Cause::shadow:
      case Cause::reflection: return settle_shaded(task, each.light, expected, than, trial) && explains(trial, task);
      case Cause::bend: return settle_bent(task, than, trial) && explains(trial, task);
      case Cause::close_cut: return settle_inside(task, than, trial) && explains(trial, task);
      default: return settle_lit(task, field, than, trial);
    }
  };
  const Likely* best = nullptr;
  for (auto each = likely.begin(); each != end; ++each) {
    std::iter_swap(each, std::max_element(each, end, less_likely));
    Fit trial = from;
    if (!settle_as(*each, plain != nullptr ? &flat : nullptr, trial)) continue;
    if (best != nullptr && unexplained(trial) >= unexplained(fit)) continue;
    fit = trial;
    best = each;
    if (explains_well(fit)) return true;
  }
  if (best == nullptr) return false;
  if (best == end - 1) return true;
  Fit again = fit;
  if (!settle_as(*best, nullptr, again)) return false;
  fit = again;
  return true;
}

}  // namespace pilotfish::vision
