// What a decision tells of actions whose values have bounds: action_values.hpp.
#include "aos/planning/action_values.hpp"

#include "check.hpp"
#include "numbers/exact.hpp"

namespace units::action_values_tests {

TEST("A value is in the middle of its own bounds, and none is above that of the choice") {
  aos::List<aos::ActionEstimate> estimates(3);
  aos::set_between(estimates, {8, -4, 7}, {10, 8, 15}, 0);
  EXPECT_NEAR(estimates[0].q, 9, 1e-12);
  EXPECT_NEAR(estimates[1].q, 2, 1e-12);  // nothing else is known of it than that it is between -4 and 8
  EXPECT_NEAR(estimates[1].standard_error, 12 / std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(estimates[2].q, 9, 1e-12);
}

TEST("An exact value that few missions were played for says so, and one with enough of them says nothing") {
  EXPECT_EQUAL(aos::unplayed_text(2), std::string{"the error is that of 2 of 30 missions that plan anew"});
  EXPECT(aos::unplayed_text(30).empty());
}

TEST("An action that earns later is taken where it gains something, and not for next to nothing") {
  const auto taken = [](double sooner, bool is_barred) {
    const aos::List<aos::ExactValue> values{{10, 10}, {sooner, 0}};
    return aos::soonest_of_best(values, [&](std::size_t action) { return is_barred && action == 1; });
  };
  EXPECT_EQUAL(taken(10 - 1e-6, false), 1u);
  EXPECT_EQUAL(taken(10 - 1e-3, false), 0u);
  EXPECT_EQUAL(taken(10 - 1e-6, true), 0u);
}

}
