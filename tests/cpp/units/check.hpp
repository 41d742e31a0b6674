// Tests of the engine's headers. A test is a sentence and a function; what it expects in vain is told with its line.
#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace units {

struct Test {
  const char* sentence;
  void (*run)();
};

inline std::vector<Test>& all_tests() {
  static std::vector<Test> tests;
  return tests;
}

struct Registered {
  Registered(const char* sentence, void (*run)()) { all_tests().push_back({sentence, run}); }
};

// What the running test has expected in vain.
inline std::vector<std::string>& failures() {
  static std::vector<std::string> texts;
  return texts;
}

inline void note(bool holds, const char* file, int line, const std::string& text) {
  if (holds) return;
  std::ostringstream where;
  where << file << ':' << line << ": " << text;
  failures().push_back(where.str());
}

template <class One, class Other>
std::string both(const char* text, const One& one, const Other& other) {
  std::ostringstream out;
  out.precision(17);
  out << text << ": " << one << " and " << other;
  return out.str();
}

}

#define UNITS_JOINED(one, other) one##other
#define UNITS_NAMED(one, other) UNITS_JOINED(one, other)

// TEST("a sentence") { ... }
#define TEST(sentence)                                                                                   \
  static void UNITS_NAMED(test_, __LINE__)();                                                            \
  static const units::Registered UNITS_NAMED(registered_, __LINE__){sentence, UNITS_NAMED(test_, __LINE__)}; \
  static void UNITS_NAMED(test_, __LINE__)()

#define EXPECT(condition) units::note((condition), __FILE__, __LINE__, #condition)
#define EXPECT_THAT(condition, text) units::note((condition), __FILE__, __LINE__, (text))
#define EXPECT_EQUAL(one, other) \
  units::note((one) == (other), __FILE__, __LINE__, units::both(#one " is not " #other, (one), (other)))
#define EXPECT_NEAR(one, other, distance)                                   \
  units::note(std::abs((one) - (other)) <= (distance), __FILE__, __LINE__, \
              units::both(#one " is not near " #other, (one), (other)))
