#pragma once

#include "tag_warp.hpp"
#include "template_samples.hpp"

namespace pilotfish::vision {

/// A tag on a bent sheet (see TagWarp), for eight samples at once.
class BentLanes {
 public:
  /// Where samples lie on the sheet and on its tangent plane.
  struct Place {
    Lanes X, Y, z, inverse_D;  ///< on the tangent plane, above it, and one over the depth's factor D
    Lanes x_u, x_v, y_u, y_v;  ///< ds / dg
    Lanes slope_x, slope_y;    ///< Q s
  };

  explicit BentLanes(const TagWarp& warp)
      : M_(warp.matrix().cast<float>()), m_(warp.normal.cast<float>()), Q_(warp.bend.cast<float>()) {}

  /// The points (x, y) of the sheet that are seen at (gu, gv), by Newton's method from those given.
  Place find(const Lanes& gu, const Lanes& gv, Lanes& x, Lanes& y) const {
    Place p;
    for (int step = 0;; ++step) {
      p.slope_x = Q_[0] * x + Q_[1] * y;
      p.slope_y = Q_[1] * x + Q_[2] * y;
      p.z = 0.5F * (x * p.slope_x + y * p.slope_y);
      const Lanes third = p.z * (1.0F / 3.0F);
      p.X = x - third * p.slope_x;
      p.Y = y - third * p.slope_y;
      p.inverse_D = (M_(2, 0) * p.X + M_(2, 1) * p.Y + 1.0F + m_[2] * p.z).inverse();
      const Lanes u = (M_(0, 0) * p.X + M_(0, 1) * p.Y + M_(0, 2) + m_[0] * p.z) * p.inverse_D;
      const Lanes v = (M_(1, 0) * p.X + M_(1, 1) * p.Y + M_(1, 2) + m_[1] * p.z) * p.inverse_D;
      // d(X, Y) / d(x, y), symmetric.
      const Lanes xx = 1.0F - (p.slope_x * p.slope_x + p.z * Q_[0]) * (1.0F / 3.0F);
      const Lanes xy = -(p.slope_x * p.slope_y + p.z * Q_[1]) * (1.0F / 3.0F);
      const Lanes yy = 1.0F - (p.slope_y * p.slope_y + p.z * Q_[2]) * (1.0F / 3.0F);
      const auto row = [&](int i, const Lanes& dX, const Lanes& dY, const Lanes& dz) -> Lanes {
        return M_(i, 0) * dX + M_(i, 1) * dY + m_[i] * dz;
      };
      const Lanes D_x = row(2, xx, xy, p.slope_x), D_y = row(2, xy, yy, p.slope_y);
      const Lanes u_x = (row(0, xx, xy, p.slope_x) - u * D_x) * p.inverse_D;
      const Lanes u_y = (row(0, xy, yy, p.slope_y) - u * D_y) * p.inverse_D;
      const Lanes v_x = (row(1, xx, xy, p.slope_x) - v * D_x) * p.inverse_D;
      const Lanes v_y = (row(1, xy, yy, p.slope_y) - v * D_y) * p.inverse_D;
      const Lanes inverse_determinant = (u_x * v_y - u_y * v_x).inverse();
      p.x_u = v_y * inverse_determinant;
      p.x_v = -u_y * inverse_determinant;
      p.y_u = -v_x * inverse_determinant;
      p.y_v = u_x * inverse_determinant;
      if (step == TagWarp::kInversionSteps) return p;
      x += p.x_u * (gu - u) + p.x_v * (gv - v);
      y += p.y_u * (gu - u) + p.y_v * (gv - v);
    }
  }

  /// The derivative of the residual with respect to curvature `i` (Qxx, Qxy, Qyy), where (a_u, a_v, c) are those with
  /// respect to the homogeneous g. The normal's own change with h is left out.
  Lanes gradient(int i, const Lanes& x, const Lanes& y, const Place& p, const Lanes& a_u, const Lanes& a_v,
                 const Lanes& c) const {
    const Lanes zero = Lanes::Zero();
    const Lanes dz = i == 0 ? Lanes(0.5F * x * x) : i == 1 ? Lanes(x * y) : Lanes(0.5F * y * y);
    const Lanes slope_dx = i == 0 ? x : i == 1 ? y : zero, slope_dy = i == 0 ? zero : i == 1 ? x : y;
    const Lanes dX = (dz * p.slope_x + p.z * slope_dx) * (-1.0F / 3.0F);
    const Lanes dY = (dz * p.slope_y + p.z * slope_dy) * (-1.0F / 3.0F);
    return a_u * (M_(0, 0) * dX + M_(0, 1) * dY + m_[0] * dz) + a_v * (M_(1, 0) * dX + M_(1, 1) * dY + m_[1] * dz) +
           c * (M_(2, 0) * dX + M_(2, 1) * dY + m_[2] * dz);
  }

 private:
  Eigen::Matrix3f M_;
  Eigen::Vector3f m_, Q_;
};

}  // namespace pilotfish::vision
