#pragma once

#include "normal_lanes.hpp"
#include "template_samples.hpp"

namespace pilotfish::vision {

/// How white the blurred template is at eight points, 0 to 1, and how that changes with the point and with the blur.
struct Whiteness {
  Lanes value = Lanes::Zero();
  Lanes dx = Lanes::Zero(), dy = Lanes::Zero();  ///< per tag coordinate
  Lanes dvx = Lanes::Zero(),
        dvy = Lanes::Zero();  ///< per variance of the blur along x and y, in tag coordinates squared
};

/// The factor of one axis: of the 2R + 1 cells around x, which share of a Gaussian at x with variance v lies on
/// each.
///
/// With c_k = Phi((l_k - x) / sqrt(v)) the share left of the line l_k, cell i has w_i = c_i - c_(i-1). With
/// z = (l_k - x) / sqrt(v) and phi = Phi',
///
///   dc/dx = -phi(z) / sqrt(v),        dc/dv = -z phi(z) / (2 v).
template <int R>
struct CellShares {
  std::array<Lanes, 2 * R + 1> w, dx, dv;

  /// `x` from the middle of the middle cell.
  CellShares(const Lanes& x, const Lanes& variance, float cell_side) {
    const Lanes inverse_sigma = variance.rsqrt();
    Lanes left = Lanes::Zero(), left_dx = Lanes::Zero(), left_dv = Lanes::Zero();
    for (int k = 0; k < 2 * R; ++k) {
      const Lanes z = ((static_cast<float>(k - R) + 0.5F) * cell_side - x) * inverse_sigma;
      const NormalLanes normal(z);
      const Lanes& c = normal.cumulative;
      const Lanes c_dx = -normal.density * inverse_sigma;
      const Lanes c_dv = 0.5F * z * inverse_sigma * c_dx;
      w[k] = c - left;
      dx[k] = c_dx - left_dx;
      dv[k] = c_dv - left_dv;
      left = c;
      left_dx = c_dx;
      left_dv = c_dv;
    }
    w[2 * R] = 1.0F - left;
    dx[2 * R] = -left_dx;
    dv[2 * R] = -left_dv;
  }
};

/// The template convolved with a Gaussian of variance `vx`, `vy` along its axes, at (x, y). A blurred grid of cells is
/// a sum over products of both axes' shares. Only the R nearest cells on each side are included: accurate up to a blur
/// of 0.4 R cells.
template <int R>
Whiteness blurred_template(const TemplateSamples& samples, int first, const Lanes& x, const Lanes& y, const Lanes& vx,
                           const Lanes& vy, float cell_side) {
  const CellShares<R> across(x - samples.column_x.segment<8>(first), vx, cell_side);
  const CellShares<R> down(y - samples.row_y.segment<8>(first), vy, cell_side);
  Whiteness sum;
  for (int j = 0, n = 0; j <= 2 * R; ++j) {
    Lanes value = Lanes::Zero(), dx = Lanes::Zero(), dv = Lanes::Zero();
    for (int i = 0; i <= 2 * R; ++i, ++n) {
      const Lanes white = samples.colour[n].segment<8>(first);
      value += across.w[i] * white;
      dx += across.dx[i] * white;
      dv += across.dv[i] * white;
    }
    sum.value += down.w[j] * value;
    sum.dx += down.w[j] * dx;
    sum.dvx += down.w[j] * dv;
    sum.dy += down.dx[j] * value;
    sum.dvy += down.dv[j] * value;
  }
  return sum;
}

}  // namespace pilotfish::vision
