// Runs every test and prints for each, as a line of JSON, what it expected in vain. With arguments it is the exam.
//
// All is one translation unit: the headers are templates, which would be compiled for each file anew.

#include "answers.hpp"
#include "aos/base/fault.hpp"
#include "aos/model/support.hpp"
#include "aos/text/json.hpp"
#include "check.hpp"

#include "action_values.cpp"
#include "belief.cpp"
#include "belief_tree.cpp"
#include "budgets.cpp"
#include "cell_tables.cpp"
#include "enumeration.cpp"
#include "expected_rewards.cpp"
#include "faults.cpp"
#include "kept_traces.cpp"
#include "learned_values.cpp"
#include "loops.cpp"
#include "number_cells.cpp"
#include "number_index.cpp"
#include "observation_doubts.cpp"
#include "option_policy.cpp"
#include "option_search.cpp"
#include "particles.cpp"
#include "point_based.cpp"
#include "progress.cpp"
#include "rollout.cpp"
#include "search_tree.cpp"
#include "seek.cpp"
#include "split_draws.cpp"
#include "state_space.cpp"
#include "text_order.cpp"
#include "wide_values.cpp"

int main(int argc, char** argv) {
  if (argc > 1) return exam::answer_problems(argc, argv);
  bool has_failed = false;
  for (const units::Test& test : units::all_tests()) {
    units::failures().clear();
    try {
      test.run();
    } catch (const std::exception& error) {
      units::failures().push_back(std::string{"it ended with "} + error.what());
    } catch (const aos::ModelFault& fault) {
      units::failures().push_back("it ended with a fault: " + fault.text);
    }
    aos::JsonWriter json;
    json.begin_object().member("test", test.sentence).key("failures").begin_array();
    for (const std::string& text : units::failures()) json.value(text);
    std::puts(json.end_array().end_object().text().c_str());
    std::fflush(stdout);  // a crash of the next test shall not take this line along
    has_failed = has_failed || !units::failures().empty();
  }
  return has_failed ? 1 : 0;
}
