#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pilotfish/fuzzy/linguistic_variable.hpp"

namespace pilotfish::fuzzy {

/// The terms of an input that may have a degree above zero, few of them as a rule. (Not bytes: a compiler must assume
/// that a byte written may be a part of anything.)
struct FuzzifiedInput {
  std::array<std::uint32_t, kMaxTerms> term;
  std::array<double, kMaxTerms> degree;
  std::size_t count;
};

/// The terms of an input variable, sorted at load by where on its universe they matter. The corners of all sets cut the
/// universe into stretches; on each, a term is zero, one, or one straight side (or a Gaussian). Degrees are the same
/// bits as membership() gives.
///
/// Stretches are numbered from the left, points among them: 0 is before the first corner, 1 is that corner itself, 2 is
/// behind it, and so on. A corner is a stretch of its own because a vertical side belongs to its set and ends there.
class Fuzzifier {
 public:
  explicit Fuzzifier(const LinguisticVariable& variable);

  std::size_t stretches() const noexcept { return begins_.size() - 1; }
  /// The terms that may have a degree above zero on a stretch.
  std::vector<std::size_t> terms_on(std::size_t stretch) const;

  /// x inside the universe (see LinguisticVariable::saturate), not NaN.
  std::size_t stretch_of(double x) const noexcept {
    const double* corners = corners_.data();
    std::size_t below = buckets_[static_cast<std::size_t>(static_cast<int>((x - min_) * buckets_per_unit_))];
    while (corners[below] < x) ++below;
    return 2 * below + (corners[below] == x ? 1 : 0);
  }
  void fuzzify(double x, std::size_t stretch, FuzzifiedInput& fuzzified) const noexcept {
    const Side* const end = sides_.data() + begins_[stretch + 1];
    std::size_t count = 0;
    for (const Side* side = sides_.data() + begins_[stretch]; side != end; ++side, ++count) {
      fuzzified.term[count] = side->term;
      fuzzified.degree[count] = side->is_gaussian ? membership(Gaussian{side->anchor, side->width}, x)
                                                  : side->offset + (x - side->anchor) / side->width;
    }
    fuzzified.count = count;
  }

 private:
  static constexpr std::size_t kBuckets = 128;

  /// degree = offset + (x - anchor)/width, where a constant has an infinite width; or a Gaussian of that mean and
  /// sigma.
  struct Side {
    std::uint32_t term;
    bool is_gaussian;
    double offset, anchor, width;
  };

  double min_, buckets_per_unit_;
  /// For each of kBuckets equal parts of the universe, a corner left of which no x of that part is, so that the search
  /// for the right one has a step to go at most as a rule. One more part for the right end itself.
  std::array<std::uint32_t, kBuckets + 1> buckets_;
  std::vector<double> corners_;  ///< inside the universe, both ends among them; then a NaN, which ends every search
  std::vector<Side> sides_;
  std::vector<std::uint32_t> begins_;  ///< of the sides of each stretch, in sides_
};

}  // namespace pilotfish::fuzzy
