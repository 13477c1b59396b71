#include "envelope.hpp"

#include <tuple>

#include "with_shape.hpp"

namespace pilotfish::fuzzy {
namespace {

// The zero of a function that changes sign between lo and hi, to adjacent doubles or 64 halvings, whichever
// is first. The envelope's integral depends on a crossing's error only to second order, because both arcs are
// equal there.
template <class Function>
double bisect(Function f, double lo, double hi) noexcept {
  const bool rising = f(hi) > 0.0;
  for (int i = 0; i < 64; ++i) {
    const double middle = 0.5 * (lo + hi);
    if (!(lo < middle && middle < hi)) break;
    ((f(middle) > 0.0) == rising ? hi : lo) = middle;
  }
  return 0.5 * (lo + hi);
}

template <class Function>
bool changes_sign(Function f, double lo, double hi) noexcept {
  return (f(lo) > 0.0 && f(hi) < 0.0) || (f(lo) < 0.0 && f(hi) > 0.0);
}

}  // namespace

Envelope::Envelope(const LinguisticVariable& variable, const double* term_strengths) noexcept
    : min_(variable.min), max_(variable.max) {
  knees_[knee_count_++] = min_;
  knees_[knee_count_++] = max_;
  for (std::size_t k = 0; k < std::min(variable.terms.size(), kMaxTerms); ++k) {
    const double height = std::min(term_strengths[k], 1.0);
    if (!(height > 0.0)) continue;
    with_shape(variable.terms[k].set, [&](const auto& shape) { add_clipped(shape, height); });
  }
  std::sort(knees_.begin(), knees_.begin() + knee_count_);
}

void Envelope::add(Arc arc) noexcept {
  arc.begin = std::max(arc.begin, min_);
  arc.end = std::min(arc.end, max_);
  if (!(arc.begin < arc.end)) return;
  arcs_[arc_count_++] = arc;
  knees_[knee_count_++] = arc.begin;
  knees_[knee_count_++] = arc.end;
}

void Envelope::add_clipped(const Triangle& set, double height) noexcept {
  add_clipped(Trapezoid{set.a, set.b, set.b, set.c}, height);
}

void Envelope::add_clipped(const Trapezoid& set, double height) noexcept {
  const auto [left, right] = level_cut(set, height);
  if (set.a < set.b) add(Arc::line(set.a, left, 0.0, 1.0 / (set.b - set.a), set.a));
  add(Arc::line(left, right, height));
  if (set.c < set.d) add(Arc::line(right, set.d, 0.0, -1.0 / (set.d - set.c), set.d));
}

// A Gaussian's curvature changes sign one sigma beside the mean. Split there, so that every arc is convex or
// concave and meets a straight line at most twice.
void Envelope::add_clipped(const Gaussian& set, double height) noexcept {
  const auto [left, right] = level_cut(set, height);
  const double left_inflection = std::min(set.mean - set.sigma, left);
  const double right_inflection = std::max(set.mean + set.sigma, right);
  add(Arc::gaussian(min_, left_inflection, set));
  add(Arc::gaussian(left_inflection, left, set));
  add(Arc::line(left, right, height));
  add(Arc::gaussian(right, right_inflection, set));
  add(Arc::gaussian(right_inflection, max_, set));
}

std::size_t Envelope::crossings(const Arc& f, const Arc& g, double begin, double end, double* out) noexcept {
  std::size_t count = 0;
  const auto keep = [&](double x) {
    if (begin < x && x < end) out[count++] = x;
  };
  if (!f.is_gaussian() && !g.is_gaussian()) {
    const double at_begin = f(begin) - g(begin), at_end = f(end) - g(end);
    if ((at_begin < 0.0) != (at_end < 0.0)) keep(begin + (end - begin) * at_begin / (at_begin - at_end));
  } else if (f.is_gaussian() && g.is_gaussian()) {
    // Two Gaussians are equal where (x - m1)/s1 = +-(x - m2)/s2.
    keep((f.mean * g.sigma + g.mean * f.sigma) / (f.sigma + g.sigma));
    if (f.sigma != g.sigma) keep((f.mean * g.sigma - g.mean * f.sigma) / (g.sigma - f.sigma));
  } else if (f.slope == 0.0 && g.slope == 0.0) {
    const auto& [gaussian, line] = f.is_gaussian() ? std::tie(f, g) : std::tie(g, f);
    for (double x : level_cut(Gaussian{gaussian.mean, gaussian.sigma}, line.level)) keep(x);
  } else {
    // Gaussian minus line is convex or concave here, so it is monotone on either side of its stationary point.
    const auto difference = [&](double x) { return f(x) - g(x); };
    const auto slope = [&](double x) { return f.derivative(x) - g.derivative(x); };
    const double turn = changes_sign(slope, begin, end) ? bisect(slope, begin, end) : end;
    if (changes_sign(difference, begin, turn)) keep(bisect(difference, begin, turn));
    if (changes_sign(difference, turn, end)) keep(bisect(difference, turn, end));
  }
  return count;
}

}  // namespace pilotfish::fuzzy
