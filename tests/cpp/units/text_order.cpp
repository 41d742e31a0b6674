// The order of texts with numbers: text_order.hpp.
#include "aos/text/text_order.hpp"

#include "check.hpp"

namespace units::text_order_tests {

using aos::order_of_texts;

TEST("A text is neither before nor after a text that it begins") {
  EXPECT_EQUAL(order_of_texts("", "7;"), 0);
  EXPECT_EQUAL(order_of_texts("7", "7;-4;"), 0);
  EXPECT_EQUAL(order_of_texts("7;-4;", "7;-4;"), 0);
}

TEST("Numbers in texts are in the order of their values, also with signs, fractions and other lengths") {
  EXPECT(order_of_texts("9;", "10;") < 0);
  EXPECT(order_of_texts("11;", "10;") > 0);
  EXPECT(order_of_texts("7;-10;", "7;-4;") < 0);
  EXPECT(order_of_texts("7;2;", "7;-4;") > 0);
  EXPECT(order_of_texts("12;", "125;") < 0);
  EXPECT(order_of_texts("1.5 m", "1.25 m") > 0);
}

TEST("Other texts are in the order of their characters, and a longer text is after its beginning") {
  EXPECT(order_of_texts("bad", "good") < 0);
  EXPECT(order_of_texts("same", "nothing") > 0);
  EXPECT(order_of_texts("gh", "g") > 0);
  EXPECT(order_of_texts("x;", "7;") > 0);
}

}
