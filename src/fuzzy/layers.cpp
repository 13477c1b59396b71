#include "layers.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish::fuzzy {
namespace {

// The level at which the line through {at level 0, at level 1} has the value x, if it gets there within [0, 1].
double level_at(const std::array<double, 2>& line, double x) {
  const double level = (x - line[0]) / (line[1] - line[0]);
  return std::isfinite(level) ? std::clamp(level, 0.0, 1.0) : 1.0;
}

// A triangle is the trapezoid with c == b. Gaussians have no place here.
const Trapezoid* as_trapezoid(const MembershipFunction& set, Trapezoid& storage) {
  if (const auto* triangle = std::get_if<Triangle>(&set))
    storage = {triangle->a, triangle->b, triangle->b, triangle->c};
  if (const auto* trapezoid = std::get_if<Trapezoid>(&set)) storage = *trapezoid;
  return std::holds_alternative<Gaussian>(set) ? nullptr : &storage;
}

}  // namespace

LayerProfile::LayerProfile(std::array<double, 2> left, std::array<double, 2> right, double min, double max) {
  // An open shoulder is at the end of the universe on every level.
  if (std::isinf(left[0])) left = {min, min};
  if (std::isinf(right[0])) right = {max, max};
  // L only rises with the level and R only falls: once they have met, nothing is left above.
  if (std::max(left[0], min) >= std::min(right[0], max)) return;
  closes_ = 1.0;
  if (left[1] > right[1])
    closes_ = std::min(closes_, (right[0] - left[0]) / ((left[1] - left[0]) + (right[0] - right[1])));
  if (left[1] > max) closes_ = std::min(closes_, level_at(left, max));
  if (right[1] < min) closes_ = std::min(closes_, level_at(right, min));

  std::array<double, 4> levels = {0.0, closes_, closes_, closes_};
  if (left[0] < min) levels[1] = std::min(level_at(left, min), closes_);
  if (right[0] > max) levels[2] = std::min(level_at(right, max), closes_);
  std::sort(levels.begin(), levels.end());
  Moments below;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    Piece& piece = pieces_[i];
    piece.top = levels[i + 1];
    const double middle = 0.5 * (levels[i] + levels[i + 1]);
    const bool held_left = left[0] + middle * (left[1] - left[0]) < min;
    const bool held_right = right[0] + middle * (right[1] - right[0]) > max;
    const double p = held_left ? min : left[0], q = held_left ? 0.0 : left[1] - left[0];
    const double s = held_right ? max : right[0], t = held_right ? 0.0 : right[1] - right[0];
    piece.area = {0.0, s - p, 0.5 * (t - q)};
    piece.first = {0.0, 0.5 * (s - p) * (s + p), 0.5 * (s * t - p * q), (t - q) * (t + q) / 6.0};
    // Continue where the piece below ends.
    const double h = levels[i];
    piece.area[0] = below.area - h * (piece.area[1] + h * piece.area[2]);
    piece.first[0] = below.first - h * (piece.first[1] + h * (piece.first[2] + h * piece.first[3]));
    const double top = piece.top;
    below = {piece.area[0] + top * (piece.area[1] + top * piece.area[2]),
             piece.first[0] + top * (piece.first[1] + top * (piece.first[2] + top * piece.first[3]))};
  }
}

LayerProfile LayerProfile::negative() const {
  LayerProfile result = *this;
  for (Piece& piece : result.pieces_) {
    for (double& c : piece.area) c = -c;
    for (double& c : piece.first) c = -c;
  }
  return result;
}

bool OrderedUnion::fits(const LinguisticVariable& variable) {
  Trapezoid before{}, now{};
  for (std::size_t k = 0; k < variable.terms.size(); ++k) {
    if (as_trapezoid(variable.terms[k].set, now) == nullptr) return false;
    if (k > 0 && !(before.a <= now.a && before.b <= now.b && before.c <= now.c && before.d <= now.d)) return false;
    before = now;
  }
  return true;
}

OrderedUnion::OrderedUnion(const LinguisticVariable& variable)
    : count_(static_cast<std::uint32_t>(variable.terms.size())),
      profiles_(variable.terms.size() * variable.terms.size()) {
  Trapezoid left{}, right{};
  for (std::uint32_t i = 0; i < count_; ++i) {
    as_trapezoid(variable.terms[i].set, right);
    for (std::uint32_t j = i; j < count_; ++j) {
      as_trapezoid(variable.terms[j].set, left);
      const LayerProfile shared({left.a, left.b}, {right.d, right.c}, variable.min, variable.max);
      profiles_[index(i, j)] = i == j ? shared : shared.negative();
    }
  }
}

OrderedUnion::Sum OrderedUnion::sum_over(const std::vector<bool>& active) const {
  Sum sum;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (!active[i]) continue;
    bool neighbours = true;
    for (std::uint32_t j = i; j < count_; ++j) {
      if (!active[j]) continue;
      if (!profiles_[index(i, j)].empty()) (neighbours ? sum.parts : sum.apart).push_back({i, j, index(i, j)});
      if (j > i) neighbours = false;
    }
  }
  return sum;
}

}  // namespace pilotfish::fuzzy
