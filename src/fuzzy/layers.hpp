#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pilotfish/fuzzy/centroid.hpp"

namespace pilotfish::fuzzy {

/// Area and first moment of a set of the form {(u, y) : L(y) <= u <= R(y), 0 < y <= h} as functions of h, where L and R
/// are the ends of level cuts: straight lines, held at the ends of the universe. With L = p + q y and R = s + t y
///   area(h)  = int_0^h (R - L) dy         = (s - p) h + (t - q) h^2/2
///   first(h) = int_0^h (R^2 - L^2)/2 dy   = (s^2 - p^2) h/2 + (s t - p q) h^2/2 + (t^2 - q^2) h^3/6
/// and a new piece begins where L or R leaves an end of the universe.
class LayerProfile {
 public:
  /// Left end of one trapezoid's cuts and right end of another's (or the same one's): {at level 0, at level 1}.
  LayerProfile(std::array<double, 2> left, std::array<double, 2> right, double min, double max);
  LayerProfile() = default;

  bool empty() const noexcept { return !(closes_ > 0.0); }
  LayerProfile negative() const;
  Moments up_to(double height) const noexcept {
    const double h = height < closes_ ? height : closes_;
    const Piece* piece = pieces_.data();
    while (h > piece->top) ++piece;  // the last piece's top is closes_
    const Piece& p = *piece;
    return {p.area[0] + h * (p.area[1] + h * p.area[2]),
            p.first[0] + h * (p.first[1] + h * (p.first[2] + h * p.first[3]))};
  }

 private:
  struct Piece {
    double top = 0.0;
    std::array<double, 3> area{};
    std::array<double, 4> first{};
  };
  double closes_ = 0.0;          ///< the level above which nothing is left between L and R
  std::array<Piece, 3> pieces_;  ///< L and R may each leave an end of the universe once
};

/// Moments of the union max_k min(term_strengths[k], mu_k(u)) of trapezoids that are ordered on the axis, without
/// looking for its knees. Layer by layer (Cavalieri): at the level y the union is that of the cuts [l_k(y), r_k(y)] of
/// the terms whose height is at least y. If l_k and r_k never fall with k, then a point that lies in the cuts of two
/// terms lies in the cuts of all between, so those it lies in follow each other, and
///   1(union) = sum_k 1(cut_k) - sum 1(cut_i and cut_j)   over neighbours i < j among the terms that reach the level y.
/// Terms i < j are neighbours at the levels between the greatest height of the terms between them and their own lesser
/// height. Integrated over y, every summand is a LayerProfile, known at load.
class OrderedUnion {
 public:
  /// Whether the terms are triangles and trapezoids with corners that never fall from one term to the next.
  static bool fits(const LinguisticVariable& variable);
  explicit OrderedUnion(const LinguisticVariable& variable);

  /// The sum above for the terms that may have a height; the others have none. No decisions are left for the loop.
  struct Sum {
    struct Part {
      std::uint32_t i, j;  ///< i == j: the term itself; i < j: what two terms share
      std::uint32_t profile;
    };
    std::vector<Part> parts;
    std::vector<Part> apart;  ///< pairs with terms between them that may have a height as well
  };
  Sum sum_over(const std::vector<bool>& active) const;

  Moments moments(const Sum& sum, const double* term_strengths) const noexcept {
    Moments total;
    const LayerProfile* const profiles = profiles_.data();
    for (const Sum::Part& part : sum.parts) {
      const Moments m = profiles[part.profile].up_to(std::min(term_strengths[part.i], term_strengths[part.j]));
      total.area += m.area;
      total.first += m.first;
    }
    for (const Sum::Part& part : sum.apart) {
      double hidden = 0.0;  // up to the greatest height between them they are no neighbours
      for (std::size_t k = part.i + 1; k < part.j; ++k) hidden = std::max(hidden, term_strengths[k]);
      const double shared = std::min(term_strengths[part.i], term_strengths[part.j]);
      const Moments m = profiles[part.profile].up_to(shared);
      const Moments not_counted = profiles[part.profile].up_to(std::min(hidden, shared));
      total.area += m.area - not_counted.area;
      total.first += m.first - not_counted.first;
    }
    return total;
  }

 private:
  std::uint32_t index(std::uint32_t i, std::uint32_t j) const noexcept { return i * count_ + j; }

  std::uint32_t count_;
  std::vector<LayerProfile> profiles_;  ///< [i * count + j], i <= j: what the terms share, negative if they are two
};

}  // namespace pilotfish::fuzzy
