#include "fuzzifier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "with_shape.hpp"

namespace pilotfish::fuzzy {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Trapezoid corners_of(const Triangle& set) { return {set.a, set.b, set.b, set.c}; }
Trapezoid corners_of(const Trapezoid& set) { return set; }
Trapezoid corners_of(const Gaussian&) { return {-kInfinity, -kInfinity, kInfinity, kInfinity}; }

}  // namespace

Fuzzifier::Fuzzifier(const LinguisticVariable& variable)
    : min_(variable.min),
      // The narrowest of universes would make it infinite.
      buckets_per_unit_(std::min(kBuckets / (variable.max - variable.min), std::numeric_limits<double>::max())) {
  std::vector<Trapezoid> sets;
  corners_ = {variable.min, variable.max};
  for (const Term& term : variable.terms) {
    const Trapezoid s = with_shape(term.set, [](const auto& shape) { return corners_of(shape); });
    for (double corner : {s.a, s.b, s.c, s.d})
      if (variable.min < corner && corner < variable.max) corners_.push_back(corner);
    sets.push_back(s);
  }
  std::sort(corners_.begin(), corners_.end());
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());

  for (std::size_t stretch = 0; stretch <= 2 * corners_.size(); ++stretch) {
    begins_.push_back(static_cast<std::uint32_t>(sides_.size()));
    const bool is_corner = stretch % 2 == 1;
    const double left = stretch < 2 ? -kInfinity : corners_[stretch / 2 - 1];
    const double right = stretch / 2 < corners_.size() ? corners_[stretch / 2] : kInfinity;
    for (std::uint32_t k = 0; k < sets.size(); ++k) {
      const Trapezoid& s = sets[k];
      if (const auto* gaussian = std::get_if<Gaussian>(&variable.terms[k].set)) {
        sides_.push_back({k, true, 0.0, gaussian->mean, gaussian->sigma});
      } else if (is_corner) {
        const double degree = membership(s, right);
        if (degree > 0.0) sides_.push_back({k, false, degree, 0.0, kInfinity});
      } else if (s.b <= left && right <= s.c) {
        sides_.push_back({k, false, 1.0, 0.0, kInfinity});
      } else if (s.a <= left && right <= s.b) {
        sides_.push_back({k, false, 0.0, s.a, s.b - s.a});
      } else if (s.c <= left && right <= s.d) {
        sides_.push_back({k, false, 0.0, s.d, s.c - s.d});
      }
    }
  }
  begins_.push_back(static_cast<std::uint32_t>(sides_.size()));
  // stretch_of() rounds when it finds the part of an x, so begin a part earlier than exact arithmetic would.
  for (std::size_t part = 0; part <= kBuckets; ++part) {
    const double begin = min_ + (static_cast<double>(part) - 1.0) / buckets_per_unit_;
    buckets_[part] =
        static_cast<std::uint32_t>(std::lower_bound(corners_.begin(), corners_.end() - 1, begin) - corners_.begin());
  }
  corners_.push_back(std::numeric_limits<double>::quiet_NaN());
}

std::vector<std::size_t> Fuzzifier::terms_on(std::size_t stretch) const {
  std::vector<std::size_t> terms;
  for (std::size_t i = begins_[stretch]; i < begins_[stretch + 1]; ++i) terms.push_back(sides_[i].term);
  return terms;
}

}  // namespace pilotfish::fuzzy
