#pragma once

#include <algorithm>

namespace pilotfish::apps {

/// Searching a whole picture is what takes longest: following takes a hundredth of it. Where one search takes longer
/// than there is until the next frame, the three after it are made coarsely, so that a near leader is found before
/// it has moved far; then a whole one again, for far leaders and to measure whether there is time now.
class SearchBudget {
 public:
  SearchBudget(double frame_rate_hz, double max_age_s) : budget_s_(std::min(1.0 / frame_rate_hz, 0.5 * max_age_s)) {}

  /// Whether the next frame is to be searched coarsely, if it has to be searched.
  bool coarse() const { return coarse_left_ > 0; }
  /// A picture was searched, as coarse() said, in so many seconds. True for the first search that took too long.
  bool searched(double seconds) {
    if (coarse_left_ > 0) {
      --coarse_left_;
      return false;
    }
    const bool slow = seconds > budget_s_, first = slow && !was_slow_;
    if (slow) coarse_left_ = kCoarseOnes;
    was_slow_ = was_slow_ || slow;
    return first;
  }
  double budget_s() const { return budget_s_; }

 private:
  static constexpr int kCoarseOnes = 3;
  double budget_s_;
  int coarse_left_ = 0;
  bool was_slow_ = false;
};

}  // namespace pilotfish::apps
