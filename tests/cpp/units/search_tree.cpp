// The memory of a search tree: search_tree.hpp.
#include "aos/planning/pomcp/search_tree.hpp"

#include "check.hpp"

namespace units::search_tree_tests {

constexpr std::size_t megabyte = std::size_t{1} << 20;

std::uint32_t action_of(const aos::SearchTree& tree, std::uint32_t history, std::uint32_t action) {
  return tree.history(history).first_action + action;
}

TEST("A child is found by its action and its observation, and by no others") {
  aos::SearchTree tree{2, megabyte};
  tree.give_actions(0);
  const std::uint32_t child = tree.add_child(action_of(tree, 0, 1), 7);
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 1), 7), child);
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 1), 8), aos::no_node);
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 0), 7), aos::no_node);
}

TEST("Few and many observations after an action are all found, also beside those of other actions") {
  aos::SearchTree tree{2, 8 * megabyte};
  tree.give_actions(0);
  aos::List<std::uint32_t> children[2];
  for (int observation = 0; observation < 500; ++observation) {
    for (std::uint32_t action = 0; action < 2; ++action) {
      children[action].push_back(tree.add_child(action_of(tree, 0, action), observation - 100));
    }
    for (int known = observation; known >= 0; known -= 37) {
      for (std::uint32_t action = 0; action < 2; ++action) {
        const std::uint32_t child = children[action][static_cast<std::size_t>(known)];
        EXPECT_EQUAL(tree.find_child(action_of(tree, 0, action), known - 100), child);
      }
    }
  }
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 0), 400), aos::no_node);
  EXPECT_EQUAL(tree.size(), 1001u);
}

TEST("A copied subtree has what is below its root, and nothing else") {
  aos::SearchTree tree{3, 8 * megabyte};
  tree.give_actions(0);
  tree.add_child(action_of(tree, 0, 0), 1);
  const std::uint32_t root = tree.add_child(action_of(tree, 0, 2), 5);
  tree.history(root).n = 11;
  tree.give_actions(root);
  tree.action(action_of(tree, root, 1)).q = 2.5;
  tree.told(tree.action(action_of(tree, root, 1))).information = 0.5;
  for (int observation = 0; observation < 9; ++observation) {
    const std::uint32_t child = tree.add_child(action_of(tree, root, 1), observation);
    tree.history(child).v = observation;
    tree.give_actions(child);
    tree.action(action_of(tree, child, 2)).n = static_cast<std::uint32_t>(observation);
  }
  aos::SearchTree copy{3, 8 * megabyte};
  copy.copy_subtree(tree, root);
  EXPECT_EQUAL(copy.size(), 10u);
  EXPECT_EQUAL(copy.history(0).n, 11u);
  EXPECT_EQUAL(copy.action(action_of(copy, 0, 1)).q, 2.5);
  EXPECT_EQUAL(copy.told(copy.action(action_of(copy, 0, 1))).information, 0.5);
  for (int observation = 0; observation < 9; ++observation) {
    const std::uint32_t child = copy.find_child(action_of(copy, 0, 1), observation);
    EXPECT(child != aos::no_node);
    if (child == aos::no_node) continue;
    EXPECT_EQUAL(copy.history(child).v, observation);
    EXPECT_EQUAL(copy.action(action_of(copy, child, 2)).n, static_cast<std::uint32_t>(observation));
  }
  EXPECT_EQUAL(copy.find_child(action_of(copy, 0, 0), 1), aos::no_node);
}

TEST("A tree that has used up its memory stops growing and keeps what it has") {
  aos::SearchTree tree{4, 4096};
  EXPECT(tree.give_actions(0));
  std::uint32_t last = 0;
  int added = 0;
  for (; added < 10'000; ++added) {
    const std::uint32_t child = tree.add_child(action_of(tree, 0, 1), added);
    if (child == aos::no_node) break;
    last = child;
  }
  EXPECT(added > 0 && added < 10'000);
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 1), added - 1), last);
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 1), added), aos::no_node);
  std::uint32_t history = 1;
  while (history < tree.size() && tree.give_actions(history)) ++history;
  EXPECT(history < tree.size());
  EXPECT(!tree.give_actions(history));
  EXPECT_EQUAL(tree.history(history).first_action, aos::no_node);
}

TEST("A cleared tree has its root only, without what was known of it") {
  aos::SearchTree tree{2, megabyte};
  tree.give_actions(0);
  for (int observation = 0; observation < 20; ++observation) tree.add_child(action_of(tree, 0, 0), observation);
  tree.history(0).n = 3;
  tree.clear();
  EXPECT_EQUAL(tree.size(), 1u);
  EXPECT_EQUAL(tree.history(0).n, 0u);
  tree.give_actions(0);
  EXPECT_EQUAL(tree.find_child(action_of(tree, 0, 0), 3), aos::no_node);
}

}
