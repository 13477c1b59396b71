#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "pilotfish/fuzzy/linguistic_variable.hpp"

namespace pilotfish::fuzzy {

/// One smooth stretch of a clipped fuzzy set, over [begin, end]: a straight line  level + slope (x - anchor),
/// or a flank of a Gaussian  exp(-(x - mean)^2 / (2 sigma^2))  that does not change the sign of its curvature.
/// Without default values on purpose: an array of arcs costs nothing until it is filled.
struct Arc {
  double begin, end;
  double level, slope, anchor;  ///< of a line
  double mean, sigma;           ///< of a Gaussian; sigma == 0 marks a line

  static Arc line(double begin, double end, double level, double slope = 0.0, double anchor = 0.0) noexcept {
    return {begin, end, level, slope, anchor, 0.0, 0.0};
  }
  static Arc gaussian(double begin, double end, const Gaussian& set) noexcept {
    return {begin, end, 0.0, 0.0, 0.0, set.mean, set.sigma};
  }

  bool is_gaussian() const noexcept { return sigma > 0.0; }
  double operator()(double x) const noexcept {
    return is_gaussian() ? membership(Gaussian{mean, sigma}, x) : level + slope * (x - anchor);
  }
  double derivative(double x) const noexcept {
    return is_gaussian() ? -(x - mean) / (sigma * sigma) * (*this)(x) : slope;
  }
};

/// The upper envelope max_k min(term_strengths[k], mu_k(x)) over the universe of a variable, as a sequence of arcs
/// that touch and do not overlap. Exact: its breakpoints are the knees of every clipped term and the
/// crossings between them. Works in fixed arrays; variables with more than kMaxTerms terms are refused by validate().
class Envelope {
 public:
  Envelope(const LinguisticVariable& variable, const double* term_strengths) noexcept;

  /// visit(begin, end, arc) from the left end of the universe to the right; a stretch that no term covers
  /// comes as an arc that is zero.
  template <class Visit>
  void for_each(Visit visit) const {
    for (std::size_t i = 0; i + 1 < knee_count_; ++i)
      if (knees_[i] < knees_[i + 1]) visit_stretch(knees_[i], knees_[i + 1], visit);
  }

 private:
  static constexpr std::size_t kArcsPerTerm = 5;  // a Gaussian: tail, flank, clipped top, flank, tail
  static constexpr std::size_t kMaxArcs = kArcsPerTerm * kMaxTerms;
  static constexpr std::size_t kMaxCrossings = kMaxTerms * (kMaxTerms - 1);  // two for each pair of terms

  template <class Visit>
  void visit_stretch(double begin, double end, Visit& visit) const {
    std::array<const Arc*, kMaxTerms> active;
    std::size_t active_count = 0;
    for (std::size_t i = 0; i < arc_count_; ++i)
      if (arcs_[i].begin <= begin && arcs_[i].end >= end) active[active_count++] = &arcs_[i];
    if (active_count == 0) return visit(begin, end, Arc::line(begin, end, 0.0));
    if (active_count == 1) return visit(begin, end, *active[0]);

    std::array<double, kMaxCrossings + 2> cuts;
    std::size_t cut_count = 0;
    cuts[cut_count++] = begin;
    for (std::size_t i = 0; i < active_count; ++i)
      for (std::size_t k = i + 1; k < active_count; ++k)
        cut_count += crossings(*active[i], *active[k], begin, end, &cuts[cut_count]);
    cuts[cut_count++] = end;
    std::sort(cuts.begin(), cuts.begin() + cut_count);

    for (std::size_t i = 0; i + 1 < cut_count; ++i) {
      if (!(cuts[i] < cuts[i + 1])) continue;
      const double middle = 0.5 * (cuts[i] + cuts[i + 1]);
      const Arc* highest = active[0];
      for (std::size_t k = 1; k < active_count; ++k)
        if ((*active[k])(middle) > (*highest)(middle)) highest = active[k];
      visit(cuts[i], cuts[i + 1], *highest);
    }
  }

  /// Writes the points of (begin, end) where two arcs cross, at most two, and returns how many.
  static std::size_t crossings(const Arc& f, const Arc& g, double begin, double end, double* out) noexcept;

  void add(Arc arc) noexcept;
  void add_clipped(const Triangle& set, double height) noexcept;
  void add_clipped(const Trapezoid& set, double height) noexcept;
  void add_clipped(const Gaussian& set, double height) noexcept;

  double min_, max_;
  std::array<Arc, kMaxArcs> arcs_;
  std::size_t arc_count_ = 0;
  std::array<double, 2 * kMaxArcs + 2> knees_;
  std::size_t knee_count_ = 0;
};

}  // namespace pilotfish::fuzzy
