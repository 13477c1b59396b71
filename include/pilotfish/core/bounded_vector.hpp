#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// A list of at most N values, stored in place: what passes through the control loop with every frame must
/// not allocate. (Decision 0012 says why not Boost's.)
template <class T, std::size_t N>
class BoundedVector {
 public:
  static constexpr std::size_t capacity() { return N; }  ///< N
  std::size_t size() const { return size_; }             ///< elements held
  bool empty() const { return size_ == 0; }              ///< no element
  bool full() const { return size_ == N; }               ///< no room for another
  void clear() { size_ = 0; }                            ///< removes all

  /// Beyond N nothing is added: callers bound their input, since the control loop does not throw.
  void push_back(T value) noexcept {
    if (!full()) values_[size_++] = std::move(value);
  }

  /// Removes the first, which is the oldest of a list by time.
  void pop_front() noexcept {
    if (empty()) return;
    std::move(begin() + 1, end(), begin());
    --size_;
  }

  T* begin() { return values_.data(); }                            ///< the first
  T* end() { return values_.data() + size_; }                      ///< behind the last
  const T* begin() const { return values_.data(); }                ///< the first
  const T* end() const { return values_.data() + size_; }          ///< behind the last
  T& operator[](std::size_t i) { return values_[i]; }              ///< not checked
  const T& operator[](std::size_t i) const { return values_[i]; }  ///< not checked
  T& front() { return values_[0]; }                                ///< not of an empty one
  const T& front() const { return values_[0]; }                    ///< not of an empty one
  const T& back() const { return values_[size_ - 1]; }             ///< not of an empty one

 private:
  std::array<T, N> values_{};
  std::size_t size_ = 0;
};

}  // namespace pilotfish
PILOTFISH_API_END
