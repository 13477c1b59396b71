#include "pilotfish/core/bounded_vector.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <type_traits>

#include "memory_asked_for.hpp"

namespace {

using pilotfish::BoundedVector;

static_assert(BoundedVector<int, 3>::capacity() == 3);
static_assert(noexcept(std::declval<BoundedVector<int, 3>&>().push_back(1)));
static_assert(noexcept(std::declval<BoundedVector<int, 3>&>().pop_front()));
static_assert(std::is_nothrow_move_constructible_v<BoundedVector<std::string, 3>>);
// Through a const list nothing can be changed.
static_assert(std::is_same_v<decltype(std::declval<const BoundedVector<int, 3>&>()[0]), const int&>);
static_assert(std::is_same_v<decltype(std::declval<const BoundedVector<int, 3>&>().begin()), const int*>);

TEST(BoundedVector, TakesNothingBeyondItsCapacity) {
  BoundedVector<int, 2> list;
  list.push_back(1);
  list.push_back(2);
  EXPECT_TRUE(list.full());
  list.push_back(3);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0], 1);
  EXPECT_EQ(list.back(), 2);
}

TEST(BoundedVector, StaysEmptyWhenTheOldestOfNothingGoes) {
  BoundedVector<int, 2> list;
  list.pop_front();  // a size of 0 - 1 would be the largest there is
  EXPECT_EQ(list.size(), 0U);
  EXPECT_EQ(list.begin(), list.end());
}

TEST(BoundedVector, KeepsTheOrderOfWhatCanOnlyBeMoved) {
  BoundedVector<std::unique_ptr<int>, 3> list;
  for (int i = 1; i <= 3; ++i) list.push_back(std::make_unique<int>(i));
  list.pop_front();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(*list.front(), 2);
  EXPECT_EQ(*list.back(), 3);
  list.push_back(std::make_unique<int>(4));
  EXPECT_EQ(*list.back(), 4);
}

TEST(BoundedVector, FreesEverythingItEverHeld) {
  const auto counted = std::make_shared<int>(0);
  {
    BoundedVector<std::shared_ptr<int>, 4> list;
    for (int i = 0; i < 9; ++i) list.push_back(counted);  // five of them do not fit
    EXPECT_EQ(counted.use_count(), 1 + 4);
    list.pop_front();
    list.clear();
  }
  EXPECT_EQ(counted.use_count(), 1);
}

TEST(BoundedVector, AsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  const auto asked = pilotfish::tests::memory_asked_for([] {
    BoundedVector<double, 64> list;
    for (int i = 0; i < 100; ++i) list.push_back(i);
    BoundedVector<double, 64> copy = list;
    copy.pop_front();
    if (copy.back() != 63.0) throw 0;  // 0..63 fit
  });
  EXPECT_EQ(asked, 0);
}

}  // namespace
