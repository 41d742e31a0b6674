// Whose fault an exception is: faults.hpp.
#include "aos/child/faults.hpp"

#include "check.hpp"

namespace units::faults_tests {

// The answer where work throws this while document code of that number runs; 0 stands for none.
template <class Thrown>
std::string answer_to(const Thrown& thrown, std::uint32_t piece) {
  aos::JsonWriter json;
  json.begin_object().member("half", 1);
  aos::guarded(json, [&] {
    aos::blame::at(piece);
    throw thrown;
  });
  return json.text();
}

TEST("An exception that document code throws is a fault of that code") {
  EXPECT_EQUAL(answer_to(std::runtime_error{"no way"}, 3), R"({"fault":{"code":"AOS215","text":"no way","piece":3}})");
  EXPECT_EQUAL(answer_to(aos::ModelFault{"AOS214", "the reward is inf"}, 2),
               R"({"fault":{"code":"AOS214","text":"the reward is inf","piece":2}})");
  EXPECT_EQUAL(aos::blame::piece(), 0u);
}

TEST("An exception while no document code runs is the engine's fault") {
  EXPECT_EQUAL(answer_to(std::out_of_range{"vector"}, 0),
               R"({"fault":{"code":"AOS217","text":"the engine failed outside of the documents' code: vector","piece":0}})");
  EXPECT_EQUAL(answer_to(7, 0).find("AOS217") != std::string::npos, true);
  EXPECT_EQUAL(answer_to(std::bad_alloc{}, 0).find("AOS213") != std::string::npos, true);
}

}
