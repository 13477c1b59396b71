#pragma once

#include "bent_lanes.hpp"
#include "blurred_template.hpp"
#include "registration_task.hpp"

namespace pilotfish::vision {

inline constexpr double kOutlier_sigmas = 3.0;  ///< a sample that differs by more is not used

/// One pass over the samples: the place of each on the tag, its expected gray level there, and the derivatives.
/// `blur_u`, `blur_v` [px^2] are what the template is blurred with, be it the picture's own blur or more.
///
/// Model::lit: the levels are those of the light field, and what the fit finds is added to them.
/// Model::bent: the curvatures of the sheet are fitted too.
/// Model::shaded: a shadow or a reflection is.
template <int R, Model M>
NormalEquations linearize(const Fit& fit, const TagPattern& pattern, const TemplateSamples& samples, double blur_u,
                          double blur_v, Rows& rows) {
  const Eigen::Matrix3f H = fit.warp.matrix().cast<float>();
  const Eigen::Matrix3f inverse = fit.warp.matrix().inverse().cast<float>();
  const auto bu = static_cast<float>(blur_u), bv = static_cast<float>(blur_v);
  const auto cell_side = static_cast<float>(pattern.cell_side);
  const auto limit = static_cast<float>(fit.noise > 0.0 ? kOutlier_sigmas * fit.noise : 1e9);
  const Eigen::Vector4f slope = fit.slopes().cast<float>();
  const BentLanes sheet(fit.warp);
  constexpr bool Bent = M == Model::bent, Lit = M == Model::lit, Shaded = M == Model::shaded;
  constexpr int N = parameters_of(M);
  const UnevenLight light = Shaded ? *fit.light : UnevenLight();
  const auto black_step = static_cast<float>(light.black_step), contrast_step = static_cast<float>(light.contrast_step);
  const auto black = static_cast<float>(fit.appearance.black), contrast = static_cast<float>(fit.appearance.contrast());
  Lanes squared_error = Lanes::Zero(), inliers = Lanes::Zero(), clipped = Lanes::Zero();
  const Lanes lane = Lanes::LinSpaced(0.0F, 7.0F);
  for (int block = 0; block < samples.blocks(); ++block) {
    const int first = samples.lanes_begin(block);
    const Lanes gu = samples.gu.segment<8>(first), gv = samples.gv.segment<8>(first);
    const Lanes w = (inverse(2, 0) * gu + inverse(2, 1) * gv + inverse(2, 2)).inverse();
    Lanes x = (inverse(0, 0) * gu + inverse(0, 1) * gv + inverse(0, 2)) * w;
    Lanes y = (inverse(1, 0) * gu + inverse(1, 1) * gv + inverse(1, 2)) * w;
    // ds / dg, and the blur carried to the tag by it.
    Lanes x_u = (inverse(0, 0) - x * inverse(2, 0)) * w, x_v = (inverse(0, 1) - x * inverse(2, 1)) * w;
    Lanes y_u = (inverse(1, 0) - y * inverse(2, 0)) * w, y_v = (inverse(1, 1) - y * inverse(2, 1)) * w;
    BentLanes::Place place;
    if constexpr (Bent) {
      place = sheet.find(gu, gv, x, y);
      x_u = place.x_u, x_v = place.x_v, y_u = place.y_u, y_v = place.y_v;
    }
    const Lanes xu2 = x_u * x_u, xv2 = x_v * x_v, yu2 = y_u * y_u, yv2 = y_v * y_v;
    const Whiteness T = blurred_template<R>(samples, first, x, y, xu2 * bu + xv2 * bv, yu2 * bu + yv2 * bv, cell_side);

    Lanes B = black + slope[0] * x + slope[1] * y, C = contrast + slope[2] * x + slope[3] * y;
    if constexpr (Lit) {
      B += samples.black.segment<8>(first);
      C += samples.white.segment<8>(first) - samples.black.segment<8>(first);
    }
    LightLanes uneven;
    if constexpr (Shaded) {
      uneven = LightLanes(light, x, y);
      B += black_step * uneven.share;
      C += contrast_step * uneven.share;
    }
    const Lanes gray = samples.gray.segment<8>(first);
    const Lanes error = gray - (B + C * T.value);
    // One for a sample that is accepted, else zero; the padding of the last block is none.
    const auto is_sample = lane < static_cast<float>(samples.count - first);
    Lanes used = ((error.abs() <= limit) && is_sample).select(Lanes::Ones(), 0.0F);
    if constexpr (Shaded) {
      const Lanes hidden = (gray >= kClipped && error <= 0.0F && is_sample).select(Lanes::Ones(), 0.0F);
      used *= 1.0F - hidden;
      clipped += hidden;
    }
    // On the tangent plane: there a flat tag has its points themselves.
    Lanes inverse_D;
    if constexpr (Bent) {
      inverse_D = place.inverse_D;
    } else {
      inverse_D = (H(2, 0) * x + H(2, 1) * y + 1.0F).inverse();
      place.X = x;
      place.Y = y;
    }
    const Lanes &X = place.X, &Y = place.Y;
    const Lanes uC = used * C;
    const Lanes a_u = -uC * (T.dx * x_u + T.dy * y_u) * inverse_D, a_v = -uC * (T.dx * x_v + T.dy * y_v) * inverse_D;
    const Lanes c = -(a_u * gu + a_v * gv);
    const auto column = [&](int i) { return rows.J.col(i).segment<8>(first).array(); };
    column(0) = a_u * X;
    column(1) = a_u * Y;
    column(2) = a_u;
    column(3) = a_v * X;
    column(4) = a_v * Y;
    column(5) = a_v;
    column(6) = c * X;
    column(7) = c * Y;
    column(kB) = used;
    column(kC) = used * T.value;
    column(kBx) = used * x;
    column(kBy) = used * y;
    column(kCx) = column(kC) * x;
    column(kCy) = column(kC) * y;
    column(kBlurU) = uC * (T.dvx * xu2 + T.dvy * yu2);
    column(kBlurV) = uC * (T.dvx * xv2 + T.dvy * yv2);
    if constexpr (Bent)
      for (int i = 0; i < 3; ++i) column(kBend + i) = sheet.gradient(i, x, y, place, a_u, a_v, c);
    if constexpr (Shaded) {
      const Lanes step = used * (black_step + contrast_step * T.value);
      column(kLight) = used * uneven.share;
      column(kLight + 1) = column(kC) * uneven.share;
      for (int i = 0; i < 3; ++i) column(kLight + 2 + i) = step * uneven.d_place[i];
    }
    rows.r.segment<8>(first) = (used * error).matrix();
    squared_error += used * error * error;
    inliers += used;
  }
  const int count = samples.lanes_begin(samples.blocks());
  const auto J = rows.J.leftCols<N>().topRows(count);
  Eigen::Matrix<float, N, N> information;
  information.noalias() = J.transpose() * J;
  NormalEquations sum;
  sum.information.topLeftCorner<N, N>() = information.template cast<double>();
  sum.gradient.head<N>() = (J.transpose() * rows.r.head(count)).template cast<double>();
  sum.squared_error = squared_error.sum();
  sum.inliers = static_cast<int>(inliers.sum());
  sum.clipped = static_cast<int>(clipped.sum());
  return sum;
}

}  // namespace pilotfish::vision
