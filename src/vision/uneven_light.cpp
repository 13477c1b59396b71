#include "uneven_light.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "normal_lanes.hpp"
#include "pilotfish/core/angles.hpp"

// Where light may end or lie is tried: so many places, of each of which the steps that explain most follow from linear
// least squares. With E the columns of what even light can explain (levels and slopes of both colours), r the residuals
// less their part in E, p the share of the light and S = (p, T p), the sum of squares falls by
//
//   g^T G^-1 g,   g = S^T r,   G = S^T S - S^T E (E^T E)^-1 E^T S.

namespace pilotfish::vision {
namespace {

constexpr int kDirections = 12, kOffsets = 13, kAcross = 7;
constexpr double kFarthest = 1.1;    ///< from the tag's middle
constexpr double kExplained = 0.25;  ///< of the sum of squares must be explained
constexpr double kMostShift = 0.3;   ///< of a place in one step, in radians or tag coordinates
constexpr double kNarrowest = 0.02, kWidest = 1.5;

/// What follows from one pass over the samples for any light.
class Search {
 public:
  Search(const Rows& rows, int padded) : rows_(rows), padded_(padded), r_(rows.r) {
    const auto E = rows.J.middleCols<6>(kB).topRows(padded);
    Eigen::Matrix<float, 6, 6> A;
    A.noalias() = E.transpose() * E;
    even_.compute(A);
    r_.head(padded).noalias() -= E * even_.solve(E.transpose() * r_.head(padded));
    explained_ = static_cast<float>(kExplained) * r_.head(padded).squaredNorm();
  }

  /// Keeps `light` with its best steps if it explains more than any before.
  void attempt(UnevenLight light) {
    const auto used = rows_.J.col(kB).array(), T = rows_.J.col(kC).array();
    const auto x = rows_.J.col(kBx).array(), y = rows_.J.col(kBy).array();
    Eigen::Vector2f g = Eigen::Vector2f::Zero();
    Eigen::Matrix2f G = Eigen::Matrix2f::Zero();
    Eigen::Matrix<float, 6, 2> common = Eigen::Matrix<float, 6, 2>::Zero();
    for (int first = 0; first < padded_; first += 8) {
      Eigen::Matrix<float, 8, 2> S;
      const Lanes share = LightLanes(light, x.segment<8>(first), y.segment<8>(first)).share;
      S.col(0) = share * used.segment<8>(first);
      S.col(1) = share * T.segment<8>(first);
      g += S.transpose() * r_.segment<8>(first);
      G += S.transpose() * S;
      common += rows_.J.block<8, 6>(first, kB).transpose() * S;
    }
    G -= common.transpose() * even_.solve(common);
    if (!(G(0, 0) > 1.0F) || !(G.determinant() > 1e-3F * G(0, 0) * G(1, 1))) return;
    const Eigen::Vector2f steps = G.inverse() * g;
    if (!(g.dot(steps) > explained_)) return;
    explained_ = g.dot(steps);
    light.black_step = steps[0];
    light.contrast_step = steps[1];
    best = light;
  }

  std::optional<UnevenLight> best;

 private:
  const Rows& rows_;
  int padded_;
  Eigen::Matrix<float, TemplateSamples::kCapacity, 1> r_;
  Eigen::LDLT<Eigen::Matrix<float, 6, 6>> even_;
  float explained_ = 0.0F;
};

double spread(int index, int count) { return kFarthest * (2.0 * index / (count - 1) - 1.0); }

}  // namespace

LightLanes::LightLanes(const UnevenLight& light, const Lanes& x, const Lanes& y) {
  const auto per_width = static_cast<float>(1.0 / light.place[2]);
  if (light.shape == UnevenLight::Shape::spot) {
    const Lanes across = (x - static_cast<float>(light.place[0])) * per_width,
                down = (y - static_cast<float>(light.place[1])) * per_width;
    share = (-0.5F * (across * across + down * down)).max(-60.0F).exp();
    d_place[0] = share * across * per_width;
    d_place[1] = share * down * per_width;
    d_place[2] = share * (across * across + down * down) * per_width;
    return;
  }
  const auto across_x = static_cast<float>(std::cos(light.place[0])),
             across_y = static_cast<float>(std::sin(light.place[0]));
  const Lanes z = (across_x * x + across_y * y - static_cast<float>(light.place[1])) * per_width;
  const NormalLanes normal(z);
  share = normal.cumulative;
  d_place[1] = -per_width * normal.density;
  d_place[0] = (across_y * x - across_x * y) * d_place[1];
  d_place[2] = z * d_place[1];
}

double UnevenLight::mean_share() const {
  double sum = 0.0;
  for (double y : {-0.75, -0.25, 0.25, 0.75}) {
    const Lanes x = Lanes::LinSpaced(-0.875F, 0.875F);
    sum += static_cast<double>(LightLanes(*this, x, Lanes::Constant(static_cast<float>(y))).share.mean());
  }
  return sum / 4.0;
}

UnevenLight UnevenLight::moved(const Eigen::Matrix<double, kLightParameters, 1>& step) const {
  UnevenLight to = *this;
  to.black_step += step[0];
  to.contrast_step += step[1];
  for (int i = 0; i < 2; ++i) to.place[i] += std::clamp(step[2 + i], -kMostShift, kMostShift);
  to.place[2] = std::clamp(place[2] + std::clamp(step[4], -0.5 * place[2], place[2]), kNarrowest, kWidest);
  return to;
}

std::optional<UnevenLight> find_uneven_light(UnevenLight::Shape shape, const Rows& rows, int count) {
  const int padded = (count + 7) / 8 * 8;
  if (padded < 4 * kShadedParameters) return std::nullopt;
  Search search(rows, padded);
  UnevenLight light;
  light.shape = shape;
  if (shape == UnevenLight::Shape::edge) {
    for (int direction = 0; direction < kDirections; ++direction)
      for (int offset = 0; offset < kOffsets; ++offset)
        for (double width : {0.06, 0.3}) {
          light.place = {kPi * direction / kDirections, spread(offset, kOffsets), width};
          search.attempt(light);
        }
  } else {
    for (int column = 0; column < kAcross; ++column)
      for (int row = 0; row < kAcross; ++row)
        for (double radius : {0.25, 0.5}) {
          light.place = {spread(column, kAcross), spread(row, kAcross), radius};
          search.attempt(light);
        }
  }
  return search.best;
}

}  // namespace pilotfish::vision
