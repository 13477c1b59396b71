#include "pilotfish/core/refused_value.hpp"

#include <gtest/gtest.h>

namespace {

using namespace pilotfish;

TEST(RefusedValue, SaysWhatWasMeasuredAndWhatIsAllowed) {
  EXPECT_EQ(to_text(at_most("reprojection error", 7.1, 3.0, "px")), "reprojection error 7.1 px, at most 3 px");
  EXPECT_EQ(to_text(at_least("side of a cell", 0.456, 0.9, "px")), "side of a cell 0.456 px, at least 0.9 px");
  EXPECT_EQ(to_text({"range", "m", 31.0, 0.05, 20.0}), "range 31 m, accepted 0.05 to 20 m");
  EXPECT_EQ(to_text(at_most("wrong bits", 2.0, 0.0)), "wrong bits 2, at most 0");
}

TEST(RefusedValue, IsEmptyWithoutANumber) {
  EXPECT_FALSE(RefusedValue{});
  EXPECT_EQ(to_text({}), "");
}

}  // namespace
