// What the baselines have in common. A problem is a class with static members:
//
//   action_count, observation_count, depth (of a search), discount, exploration (the constant of UCB1)
//   struct State                                          trivially copyable
//   State start(Random&)                                  a draw from the initial belief
//   Outcome step(State&, int action, Random&)             one step, in place
//   int legal_action(const State&, Random&)               for play-outs that know nothing
//   int promising_action(const State&, Random&)           for play-outs that use what the robot has learnt
#pragma once


namespace bench {

struct Outcome {
  float reward = 0;
  int observation = 0;
  bool ends = false;
};

enum class PlayOut { legal, promising };

}
