#pragma once

#include "registration_task.hpp"

namespace pilotfish::vision {

/// The least-squares problem of the task's model and samples, with the picture's blur and `extra_blur_px2` more.
NormalEquations linearized(Task& task, const Fit& fit, double extra_blur_px2);

/// The step to the minimum of the parameters of a model; the others stay.
Parameters solved(Model model, const NormalEquations& sum);

/// How far the corners of a tag lie apart in both, at most [px].
double largest_move(const TagWarp& before, const TagWarp& after);

/// From far away: a template blurred by a third of a cell converges from a third of a cell away. False if it does not.
bool pull_in(Task& task, Fit& fit);

/// From near by, with the picture's own blur. Unless it was `pulled_in` already, a step on few samples goes ahead, so
/// that the many lie evenly about the edges. False if it does not converge.
bool settle(Task& task, bool pulled_in, Fit& fit);

}  // namespace pilotfish::vision
