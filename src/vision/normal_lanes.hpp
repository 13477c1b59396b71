#pragma once

#include "template_samples.hpp"

namespace pilotfish::vision {

/// The normal distribution for eight values at once: density phi(z) and cumulative Phi(z).
struct NormalLanes {
  Lanes density, cumulative;

  explicit NormalLanes(const Lanes& z) {
    const Lanes size = z.abs().min(8.0F);
    density = 0.39894228F * (-0.5F * size * size).exp();
    // Abramowitz and Stegun 26.2.16: |error| < 1e-5, a four-hundredth of a gray level.
    const Lanes t = (1.0F + 0.33267F * size).inverse();
    const Lanes tail = density * t * (0.4361836F + t * (-0.1201676F + t * 0.9372980F));
    cumulative = (z > 0.0F).select(1.0F - tail, tail);
  }
};

}  // namespace pilotfish::vision
