#include "pilotfish/core/se3.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace {

using namespace pilotfish;
using Eigen::Isometry3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

Vector6d element(const Vector3d& v, const Vector3d& w) {
  Vector6d both;
  both << v, w;
  return both;
}

/// The matrix whose exponential the motion is, and the exponential as its own definition: the power series of a 2^-20th
/// of it, squared 20 times. Shares no formula with exp().
Matrix4d by_power_series(const Vector6d& velocity) {
  constexpr int kSquarings = 20;
  Matrix4d a = Matrix4d::Zero();
  const Vector3d w = velocity.tail<3>();
  for (int i = 0; i < 3; ++i) a.block<3, 1>(0, i) = w.cross(Vector3d::Unit(i));
  a.block<3, 1>(0, 3) = velocity.head<3>();
  a /= 1 << kSquarings;
  // Without the identity, which would swallow the digits of what is added to it: (I + s)^2 = I + (2 s + s^2).
  Matrix4d s = a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
  for (int i = 0; i < kSquarings; ++i) s = (2.0 * s + s * s).eval();
  return Matrix4d::Identity() + s;
}

/// Turns of all sizes about all axes, from those that are rounding to those just below half a turn.
std::vector<Vector6d> many_elements() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vector6d> all = {Vector6d::Zero()};
  const auto any = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  for (const double angle : {1e-12, 1e-8, 0.99e-4, 1.01e-4, 1e-3, 0.1, 1.0, 2.0, 3.0, 3.1})
    for (int i = 0; i < 20; ++i) all.push_back(element(any(), angle * any().normalized()));
  return all;
}

TEST(Se3, HatIsTheCrossProduct) {
  const Vector3d a(1.0, -2.0, 0.5), b(0.3, 4.0, -1.0);
  EXPECT_TRUE((se3::hat(a) * b).isApprox(a.cross(b)));
  EXPECT_EQ(se3::hat(a), (-se3::hat(a).transpose()).eval());
}

TEST(Se3, ExpIsWhatItsPowerSeriesSays) {
  for (const Vector6d& velocity : many_elements()) {
    const Matrix4d truth = by_power_series(velocity);
    EXPECT_LT((se3::exp(velocity).matrix() - truth).cwiseAbs().maxCoeff(), 1e-8 * std::max(1.0, velocity.norm()))
        << velocity.transpose();
  }
}

TEST(Se3, AQuarterTurnIsAQuarterCircle) {
  // Ahead at 1 m/s while turning left by 90 degrees in 1 s: an arc of radius 2 / pi, which ends a radius ahead and one
  // to the left.
  const Isometry3d motion = se3::exp(element({1.0, 0.0, 0.0}, {0.0, 0.0, kPi / 2.0}));
  EXPECT_TRUE(motion.translation().isApprox(Vector3d(2.0 / kPi, 2.0 / kPi, 0.0), 1e-12));
  EXPECT_TRUE(motion.linear().col(0).isApprox(Vector3d::UnitY(), 1e-12));
}

TEST(Se3, LogIsTheInverseOfExp) {
  for (const Vector6d& velocity : many_elements())
    EXPECT_LT((se3::log(se3::exp(velocity)) - velocity).cwiseAbs().maxCoeff(), 1e-7) << velocity.transpose();
}

TEST(Se3, GoingOnIsExpOfTheSum) {
  // Along one (v, w) motions commute: exp(a x) exp(b x) = exp((a + b) x).
  for (const Vector6d& velocity : many_elements())
    EXPECT_TRUE((se3::exp(0.3 * velocity) * se3::exp(0.7 * velocity)).isApprox(se3::exp(velocity), 1e-9));
}

TEST(Se3, NoStepWhereTheSeriesTakesOver) {
  // On both sides of 1e-4 the factor is I + w/2 x + w^2/6 to 1e-13.
  for (const double angle : {1e-4 * (1.0 - 1e-9), 1e-4 * (1.0 + 1e-9)}) {
    const Vector3d w(0.0, 0.0, angle);
    const Eigen::Matrix3d expected = Eigen::Matrix3d::Identity() + 0.5 * se3::hat(w) + se3::hat(w) * se3::hat(w) / 6.0;
    EXPECT_LT((se3::translation_factor(w) - expected).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Se3, TheAngleBetweenOrientationsIsThatOfTheTurn) {
  for (const Vector6d& velocity : many_elements()) {
    const Isometry3d a = se3::exp(element({1.0, 2.0, 3.0}, {0.4, -0.2, 0.9}));
    EXPECT_NEAR(se3::angle_between(a, a * se3::exp(velocity)), velocity.tail<3>().norm(), 1e-7);
  }
}

}  // namespace
