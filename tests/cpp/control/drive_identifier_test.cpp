#include "pilotfish/control/drive_identifier.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace {

using namespace pilotfish;
using namespace pilotfish::control;
using Identifier = DriveIdentifier;
using Grid = std::array<double, Identifier::kLatencies * Identifier::kLags>;

/// Of what the identifier remembers, replaces the logarithms of the probabilities, and behind them the recent costs.
struct Belief {
  const Grid& grid;
  const Grid& cost;
  bool probabilities_are_replaced = false;
  template <class... T>
  void operator()(T&... values) {
    (replace(values), ...);
  }
  template <class T>
  void replace(T& value) {
    if constexpr (std::is_same_v<T, Grid>) value = std::exchange(probabilities_are_replaced, true) ? cost : grid;
  }
};

/// The logarithm of a Gaussian over the grid's places (latency, lag).
Grid gaussian(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance) {
  const Eigen::Matrix2d information = covariance.inverse();
  Grid grid;
  for (std::size_t i = 0; i < Identifier::kLatencies; ++i)
    for (std::size_t j = 0; j < Identifier::kLags; ++j) {
      const Eigen::Vector2d off = Eigen::Vector2d(static_cast<double>(i), static_cast<double>(j)) - mean;
      grid[i * Identifier::kLags + j] = -0.5 * off.dot(information * off);
    }
  return grid;
}

Eigen::Matrix2d covariance_of(double latency, double lag, double correlation) {
  Eigen::Matrix2d result;
  result << latency * latency, correlation * latency * lag, correlation * latency * lag, lag * lag;
  return result;
}

double latency_at(double place) { return Identifier::kFirstLatency_s + Identifier::kLatencyStep_s * place; }
double lag_at(double place) { return Identifier::kLagScale_s * std::expm1(Identifier::kLagRatio * place); }

/// What it all cost if the belief came of it just now, beside `common` for every place.
Grid cost_of(const Grid& grid, double common) {
  Grid cost;
  std::transform(grid.begin(), grid.end(), cost.begin(), [&](double each) { return common - each; });
  return cost;
}

/// What is estimated with that belief. Robot and leader stand, so that frames add nothing to it.
DriveEstimate estimate_with(const Grid& grid, const DriveModelConfig& configured = {}, double common_cost = 0.0) {
  Identifier identifier(configured, {});
  std::int64_t utime = 0;
  const auto see = [&] {
    identifier.command({}, utime);
    identifier.observe(utime += 33'333, 1.0, 0.1);
  };
  for (int k = 0; k < 60; ++k) see();
  const Grid cost = cost_of(grid, common_cost);
  Belief belief{grid, cost};
  Identifier::remember(identifier, belief);
  see();
  return identifier.estimate();
}

TEST(DriveIdentifier, EstimatesTheVertexAndTheWidthOfWhatItBelieves) {
  // A parabola through nine places of a Gaussian's logarithm is that Gaussian: mean and covariance come out exactly, in
  // the units of the grid. Standard deviations of 0.8 and 0.6 places, 16 ms and 0.234 of the lag, are sure enough to
  // be used; the settings (33 ms, 0.1 s) are at (1.2, 3.8), many of those away.
  for (const Eigen::Vector2d& mean : {Eigen::Vector2d(8.3, 5.2), {7.6, 5.4}, {11.1, 3.8}})
    for (const double correlation : {0.0, 0.5, -0.4}) {
      const DriveEstimate found = estimate_with(gaussian(mean, covariance_of(0.8, 0.6, correlation)));
      EXPECT_TRUE(found.differs_from_settings);
      EXPECT_NEAR(found.latency_s, latency_at(mean[0]), 1e-9) << mean.transpose() << ", " << correlation;
      EXPECT_NEAR(found.actuator_lag_s, lag_at(mean[1]), 1e-9) << mean.transpose() << ", " << correlation;
      EXPECT_NEAR(found.latency_sigma_s, 0.8 * Identifier::kLatencyStep_s, 1e-9);
      EXPECT_NEAR(found.actuator_lag_sigma_s, 0.6 * Identifier::kLagRatio * (lag_at(mean[1]) + Identifier::kLagScale_s),
                  1e-9);
    }
}

TEST(DriveIdentifier, UsesWhatItBelievesOnlyWhereItIsSure) {
  // 20 ms, which is one place, and 0.3 of the lag, 0.77 places, are the limits of either.
  const Eigen::Vector2d mean(8.3, 5.2);
  EXPECT_TRUE(estimate_with(gaussian(mean, covariance_of(0.99, 0.76, 0.0))).differs_from_settings);
  for (const auto& covariance : {covariance_of(1.01, 0.6, 0.0), covariance_of(0.8, 0.78, 0.0)}) {
    const DriveEstimate found = estimate_with(gaussian(mean, covariance));
    EXPECT_FALSE(found.differs_from_settings);
    EXPECT_EQ(found.latency_s, DriveModelConfig{}.latency_s);
    EXPECT_EQ(found.actuator_lag_s, DriveModelConfig{}.actuator_lag_s);
    EXPECT_NEAR(found.latency_sigma_s, std::sqrt(covariance(0, 0)) * Identifier::kLatencyStep_s, 1e-9);
  }
}

TEST(DriveIdentifier, KeepsSettingsThatAreNotMuchLessProbable) {
  // Settings on a place of the grid, which the belief puts at n standard deviations of the latency: exp(-n^2 / 2), and
  // e^-3 is the limit: n = 2.45. Of the four places around a setting the most probable counts: here that one.
  DriveModelConfig configured;
  configured.latency_s = latency_at(4.0) + 1e-6;
  configured.actuator_lag_s = lag_at(4.0) + 1e-6;
  // The best place, to which the probabilities are relative, is the mean itself.
  EXPECT_FALSE(
      estimate_with(gaussian({2.0, 4.0}, covariance_of(2.0 / 2.4, 0.6, 0.0)), configured).differs_from_settings);
  EXPECT_TRUE(
      estimate_with(gaussian({1.0, 4.0}, covariance_of(3.0 / 3.8, 0.6, 0.0)), configured).differs_from_settings);
}

TEST(DriveIdentifier, KeepsSettingsThatExplainAQuarterAsMuch) {
  // Settings on a place of the grid, 4 standard deviations of the latency from the mean, which is on one, too: they
  // have cost 8 more. With c for every place the costs are c + 8 and c: four times as much up to c = 8 / 3.
  DriveModelConfig configured;
  configured.latency_s = latency_at(4.0) + 1e-6;
  configured.actuator_lag_s = lag_at(4.0) + 1e-6;
  // The settings' four places include the next one nearer to or farther from the mean: here 4 and 5, and the mean is 2.
  const Grid grid = gaussian({2.0, 4.0}, covariance_of(0.5, 0.6, 0.0));
  EXPECT_TRUE(estimate_with(grid, configured, 2.5).differs_from_settings);
  EXPECT_FALSE(estimate_with(grid, configured, 2.8).differs_from_settings);
}

}  // namespace
