#include "pilotfish/control/leader_rhythm.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using pilotfish::control::LeaderRhythm;
using Planar = LeaderRhythm::Planar;
constexpr double kSpacing_s = 4.0 / 30.0, kKeep = 0.99;

/// |e|^2 of the last of 60 values of a track.
template <class Track>
double last_unexplained_m2(const Track& track) {
  LeaderRhythm rhythm;
  double last_m2 = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double t = k / 30.0;
    last_m2 = rhythm.unexplained_m2({track(t), track(t - kSpacing_s), track(t - 2.0 * kSpacing_s)}, 1.0, kKeep);
  }
  return last_m2;
}

TEST(LeaderRhythm, ExplainsASineOfAnyFrequencyAndDirection) {
  // sin(w t) = 2 cos(w T) sin(w (t - T)) - sin(w (t - 2 T)). The ridge, (0.2 mm)^2, takes away less than 1e-4 of a
  // swing of 50 mm.
  for (const double frequency_hz : {0.3, 0.8, 1.0, 2.0})
    for (const double direction : {0.0, 1.0, 2.5}) {
      const auto swing = [&](double t) {
        const double s = 0.05 * std::sin(2.0 * M_PI * frequency_hz * t + 0.4);
        return Planar{s * std::cos(direction), s * std::sin(direction)};
      };
      EXPECT_LT(std::sqrt(last_unexplained_m2(swing)), 0.05 * 2e-3) << frequency_hz << " Hz, " << direction;
    }
}

TEST(LeaderRhythm, DoesNotExplainWhatComesOfNothing) {
  // A jump of 3 mm after rest: r' and r'' are zero, and what they are multiplied by does not matter.
  const auto jump = [](double t) { return Planar{t < 59.0 / 30.0 - 1e-9 ? 0.0 : 0.003, 0.0}; };
  EXPECT_NEAR(std::sqrt(last_unexplained_m2(jump)), 0.003, 1e-12);
}

TEST(LeaderRhythm, DoesNotExplainNoiseByNoise) {
  // Two coefficients learned from 60 pairs of numbers explain about 2 / 60 of their variance, and the ridge, which is
  // as large as the noise's, less: what is left is within a tenth of it, give or take the last value's own leverage.
  LeaderRhythm rhythm;
  unsigned state = 1;
  const auto noise = [&] {
    state = state * 1664525u + 1013904223u;
    return 0.0002 * std::sqrt(12.0) * (static_cast<double>(state) / 4294967296.0 - 0.5);
  };
  double left_m2 = 0.0, all_m2 = 0.0;
  for (int k = 0; k < 600; ++k) {
    const Planar r{noise(), noise()};
    const double e2 = rhythm.unexplained_m2({r, {noise(), noise()}, {noise(), noise()}}, 1.0, kKeep);
    if (k < 60) continue;
    left_m2 += e2;
    all_m2 += r.x_m * r.x_m + r.y_m * r.y_m;
  }
  EXPECT_GT(left_m2, 0.9 * all_m2);
}

}  // namespace
