#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "even_controller.hpp"
#include "memory_asked_for.hpp"
#include "pilotfish/fuzzy/centroid.hpp"
#include "pilotfish/fuzzy/mamdani.hpp"

namespace {

using namespace pilotfish::fuzzy;
using pilotfish::tests::even_controller;
using pilotfish::tests::even_terms;
using pilotfish::tests::validated_controller;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

static_assert(noexcept(infer(std::declval<const Controller&>(), 0.0, 0.0)));
static_assert(noexcept(infer_output(std::declval<const Controller&>(), 0.0, 0.0)));
static_assert(noexcept(membership(std::declval<const MembershipFunction&>(), 0.0)));
static_assert(noexcept(clipped_union_moments(std::declval<const LinguisticVariable&>(), nullptr)));
static_assert(std::is_nothrow_move_constructible_v<Controller> && std::is_nothrow_move_assignable_v<Controller>);
static_assert(std::is_trivially_copyable_v<Inference>);  // goes through the control loop with every frame

/// Where validate() sees a fault; "nowhere" if it sees none.
std::string fault(Controller controller) {
  try {
    validate(controller);
  } catch (const ValidationError& error) {
    EXPECT_EQ(std::string(error.what()), error.where() + ": " + error.problem());
    return error.where();
  }
  return "nowhere";
}

TEST(Inference, FiresTheTwoRulesThatShareTheMiddle) {
  // E = 0 is half way between the peaks of rows 3 and 4 at -+1/7, EC = 0 is the peak of column 3: two rules at 1/2.
  // Both say the middle term, which is even about 0.
  const Inference inference = infer(validated_controller(), 0.0, 0.0);
  EXPECT_NEAR(inference.output, 0.0, 1e-15);
  for (std::size_t rule = 0; rule < kPaperRules; ++rule) {
    const bool fires = rule == 3 * kPaperColumns + 3 || rule == 4 * kPaperColumns + 3;
    EXPECT_NEAR(inference.strengths[rule], fires ? 0.5 : 0.0, 1e-12) << rule;
  }
}

TEST(Inference, IsTheCentroidOfTheTermAtTheEndOfTheUniverse) {
  // E = -1 fires row 0 alone, which says U6: the half triangle from 2/3 to 1 that rises to its right end. Its centroid
  // is two thirds of the way along: 2/3 + 2/9 = 8/9.
  EXPECT_NEAR(infer(validated_controller(), -1.0, 0.0).output, 8.0 / 9.0, 1e-12);
}

TEST(Inference, IsOddWhereTheRulesAre) {
  const Controller controller = validated_controller();
  for (double e = -1.0; e <= 1.0; e += 0.0625)
    EXPECT_NEAR(infer(controller, e, 0.25).output, -infer(controller, -e, 0.25).output, 1e-12) << e;
}

TEST(Inference, SaturatesBeyondTheUniverse) {
  const Controller controller = validated_controller();
  const double at_the_end = infer(controller, 1.0, -1.0).output;
  EXPECT_EQ(infer(controller, 7.0, -1e300).output, at_the_end);
  EXPECT_EQ(infer(controller, kInfinity, -kInfinity).output, at_the_end);
}

TEST(Inference, IsNoNumberWhereNothingWasMeasured) {
  const Controller controller = validated_controller();
  EXPECT_TRUE(std::isnan(infer(controller, std::nan(""), 0.0).output));
  EXPECT_TRUE(std::isnan(infer(controller, 0.0, std::nan("")).output));
  EXPECT_TRUE(std::isnan(infer(controller, 0.0, 0.0, {kInfinity, 0.0}).output));
  for (double strength : infer(controller, std::nan(""), 0.0).strengths) EXPECT_EQ(strength, 0.0);
}

TEST(Inference, IsNoNumberWithoutValidation) {
  EXPECT_TRUE(std::isnan(infer(even_controller(), 0.0, 0.0).output));
  EXPECT_TRUE(std::isnan(infer(Controller{}, 0.0, 0.0).output));
}

TEST(Inference, HasTheSameBitsWithoutItsReasons) {
  const Controller controller = validated_controller();
  for (double e = -1.25; e <= 1.25; e += 0.09)
    EXPECT_EQ(infer_output(controller, e, e / 2, {0.1, 0.2}), infer(controller, e, e / 2, {0.1, 0.2}).output);
}

TEST(Inference, AsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  const Controller controller = validated_controller();
  const auto asked = pilotfish::tests::memory_asked_for([&] {
    double sum = 0.0;
    for (double e = -1.5; e <= 1.5; e += 0.01)
      for (WidthShape shape : {WidthShape::triangle, WidthShape::gaussian})
        sum += infer(controller, e, -e, {0.2, 0.1, shape}).output + infer(controller, e, -e).output;
    if (std::isnan(sum)) throw 0;
  });
  EXPECT_EQ(asked, 0);
}

TEST(Controller, InfersTheSameInACopyAndAfterAMove) {
  Controller original = validated_controller();
  const double output = infer(original, 0.3, -0.2).output;
  const Controller copy = original;
  const Controller moved = std::move(original);
  EXPECT_EQ(infer(copy, 0.3, -0.2).output, output);
  EXPECT_EQ(infer(moved, 0.3, -0.2).output, output);
}

TEST(Controller, InfersTheSameAfterItsCopyIsValidatedAgainWithOtherRules) {
  const Controller original = validated_controller();
  const double output = infer(original, 0.9, 0.0).output;
  Controller other = original;
  other.rules.consequents.assign(kPaperRules, 6);
  validate(other);
  EXPECT_EQ(infer(original, 0.9, 0.0).output, output);  // they share no plan any more
  EXPECT_NE(infer(other, 0.9, 0.0).output, output);
}

TEST(Validate, LeavesNoPlanBehindWhenItFails) {
  Controller controller = validated_controller();
  controller.error.terms.push_back({"E8", Triangle{0.5, 1.0, 1.5}});  // a ninth, for which there is no rule
  EXPECT_THROW(validate(controller), ValidationError);
  EXPECT_EQ(controller.plan, nullptr);
  EXPECT_TRUE(std::isnan(infer(controller, 1.0, 0.0).output));
  EXPECT_TRUE(std::isnan(infer(controller, 1.0, 0.0, {0.1, 0.1}).output));  // a non-singleton input overlaps every term
}

TEST(Validate, SaysWhichCellHasNoTerm) {
  Controller controller = even_controller();
  controller.rules.consequents[2 * kPaperColumns + 5] = 7;  // U has the terms 0 to 6
  EXPECT_EQ(fault(controller), "rules.E2.EC5");
}

TEST(Validate, CountsTheCells) {
  Controller controller = even_controller();
  controller.rules.consequents.pop_back();
  EXPECT_EQ(fault(controller), "rules");
  controller.rules.consequents.assign(kPaperRules + 1, 0);
  EXPECT_EQ(fault(controller), "rules");
}

TEST(Validate, FindsAGapBetweenTwoTerms) {
  Controller controller = even_controller();
  controller.error_change.terms[3].set = Triangle{-0.01, 0.0, 0.01};  // its neighbours end at 0
  EXPECT_EQ(fault(controller), "nowhere");                            // they cover it up to the peak
  controller.error_change.terms[2].set = Triangle{-2.0 / 3, -1.0 / 3, -0.1};
  EXPECT_EQ(fault(controller), "EC.terms");
}

TEST(Validate, SeesATermOutsideTheUniverse) {
  Controller controller = even_controller();
  controller.output.terms[6].set = Triangle{1.0, 2.0, 3.0};
  EXPECT_EQ(fault(controller), "U.terms.U6");
}

TEST(LinguisticVariable, HasAtMostSixteenTerms) {
  EXPECT_NO_THROW(validate(even_terms("X", kMaxTerms)));
  EXPECT_THROW(validate(even_terms("X", kMaxTerms + 1)), ValidationError);
  EXPECT_THROW(validate(LinguisticVariable{"X", -1.0, 1.0, {}}), ValidationError);
}

TEST(LinguisticVariable, ListsItsLabelsToWhoAsksForAnother) {
  try {
    even_terms("X", 3).index_of("Y");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "'Y' is not a term of X; terms: X0, X1, X2");
  }
}

TEST(Membership, IsOneAtAVerticalSideAndNothingBesideIt) {
  const Triangle step{0.0, 0.0, 1.0};
  EXPECT_EQ(membership(step, 0.0), 1.0);
  EXPECT_EQ(membership(step, std::nextafter(0.0, -1.0)), 0.0);
  EXPECT_EQ(membership(step, 0.25), 0.75);
}

TEST(Membership, IsOneAllAlongAnOpenShoulder) {
  const Trapezoid left{-kInfinity, -kInfinity, 0.0, 1.0};
  EXPECT_EQ(membership(left, -kInfinity), 1.0);
  EXPECT_EQ(membership(left, -1e308), 1.0);
  EXPECT_EQ(membership(left, 0.5), 0.5);
  EXPECT_EQ(membership(left, kInfinity), 0.0);
}

TEST(Membership, IsNoNumberForNoNumber) {
  for (const MembershipFunction& set : {MembershipFunction(Triangle{0, 1, 2}),
                                        MembershipFunction(Trapezoid{0, 1, 2, 3}), MembershipFunction(Gaussian{0, 1})})
    EXPECT_TRUE(std::isnan(membership(set, std::nan(""))));
}

TEST(Membership, IsRefusedInTheWordsOfItsFormula) {
  EXPECT_THROW(validate(MembershipFunction(Triangle{1, 0, 2})), std::invalid_argument);
  EXPECT_THROW(validate(MembershipFunction(Triangle{1, 1, 1})), std::invalid_argument);  // no area
  EXPECT_THROW(validate(MembershipFunction(Gaussian{0, 0})), std::invalid_argument);
  EXPECT_THROW(validate(MembershipFunction(Gaussian{std::nan(""), 1})), std::invalid_argument);
  EXPECT_THROW(validate(MembershipFunction(Trapezoid{0, 1, 0.5, 3})), std::invalid_argument);
}

}  // namespace
