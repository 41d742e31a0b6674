// Numbers by hashes: number_index.hpp.
#include "aos/base/number_index.hpp"

#include "aos/base/mixed.hpp"
#include "check.hpp"

namespace units::number_index_tests {

struct Words {
  aos::List<std::string> all;
  aos::NumberIndex index;

  auto is(const std::string& word) const {
    return [this, word](std::uint32_t number) { return all[number] == word; };
  }
  std::uint32_t add(const std::string& word, std::uint64_t hash) {
    const auto next = static_cast<std::uint32_t>(all.size());
    const std::uint32_t number = index.find_or_add(hash, next, is(word));
    if (number == next) all.push_back(word);
    return number;
  }
};

TEST("A number is found by its hash while an index grows, and what was not added is not found") {
  Words words;
  for (std::uint32_t i = 0; i < 5'000; ++i) EXPECT_EQUAL(words.add(std::to_string(i), aos::mixed(0, i)), i);
  EXPECT_EQUAL(words.index.size(), 5'000u);
  for (std::uint32_t i = 0; i < 5'000; ++i) {
    EXPECT_EQUAL(words.index.find(aos::mixed(0, i), words.is(std::to_string(i))), i);
  }
  for (std::uint32_t i = 5'000; i < 10'000; ++i) {
    EXPECT_EQUAL(words.index.find(aos::mixed(0, i), words.is(std::to_string(i))), aos::NumberIndex::none);
  }
}

TEST("Things with one hash are told apart, and things whose hashes share a place") {
  Words words;
  for (std::uint32_t i = 0; i < 200; ++i) EXPECT_EQUAL(words.add(std::to_string(i), i % 2 == 0 ? 7 : 7 + (std::uint64_t{i} << 20)), i);
  for (std::uint32_t i = 0; i < 200; ++i) {
    EXPECT_EQUAL(words.add(std::to_string(i), i % 2 == 0 ? 7 : 7 + (std::uint64_t{i} << 20)), i);
  }
  EXPECT_EQUAL(words.index.size(), 200u);
  EXPECT_EQUAL(words.index.find(7, words.is("1")), aos::NumberIndex::none);
}

TEST("An index has nothing before anything was added, and nothing after it was cleared") {
  Words words;
  EXPECT_EQUAL(words.index.find(3, words.is("three")), aos::NumberIndex::none);
  words.add("three", 3);
  words.index.clear();
  EXPECT_EQUAL(words.index.size(), 0u);
  EXPECT_EQUAL(words.index.find(3, words.is("three")), aos::NumberIndex::none);
}

}
