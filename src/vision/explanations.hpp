#pragma once

#include <initializer_list>

#include "registration_task.hpp"

namespace pilotfish::vision {

/// What may explain a picture that a flat, evenly lit tag with a white ring does not.
enum class Cause { shadow, reflection, bend, close_cut, light };

/// Whether a fit converged to the tag and not to some other edge: then it explains the picture well.
bool explains(const Fit& fit);

/// Whether a bend could better the fit of a flat tag, which `task` holds too, by so much that it is worth while. This
/// is the score test, for which the bend itself need not be fitted.
bool may_be_bent(Task& task, const Fit& flat);

/// Fits a sheet that is bent, from `plain` or, if that is none, from `fit` as it is. False if it does not converge or
/// explains the picture hardly better.
bool settle_bent(Task& task, const Fit* plain, Fit& fit);

/// Tries `causes` from `start` and takes the one that leaves the least of the picture unexplained, if there is one that
/// is better than `plain`. `task`, which holds the normal equations of `plain`, then holds those of the result.
/// `expected`: where the tag was looked for.
bool settle_best(std::initializer_list<Cause> causes, Task& task, const TagWarp& expected, const Fit* plain,
                 const Fit& start, Fit& fit);

}  // namespace pilotfish::vision
