// The whole model as numbers, for a solver in another process. It lists every outcome of every action in
// every state that can be reached.
#pragma once

#include "aos/base/descriptor_file.hpp"
#include "aos/child/left_out.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/text/json.hpp"
#include "point_based/flat_file.hpp"

namespace aos {

template <class Model>
class Listing {
 public:
  // Throws NotEnumerable.
  Listing(const Belief<Model>& belief, std::size_t max_states) : belief_(belief), space_(limits(max_states)) {
    if (!space_.lists_observations()) throw NotEnumerable{numbers_are_observed};
    if (!belief.is_exact()) throw NotEnumerable{"the initial belief is only known by samples"};
    space_.reach_within(belief_, 0);
  }

  // Lists what one more decision leads to, and writes how many states are listed and known. Throws NotEnumerable.
  void go_on(JsonWriter& json) {
    space_.reach_within(belief_, 1);
    json.begin_object().member("listed", space_.rows().states).member("known", space_.size()).end_object();
  }

  // Writes the model, with the belief as its start, to a descriptor, and behind it the states' texts, one a line.
  // Ended states have no number: the probability that a row lacks is that of an end.
  void write(JsonWriter& json, int descriptor) const {
    point_based::FlatModel model = space_.rows();
    if (auto start = space_.weights_of(belief_); !start.empty()) model.starts.push_back({1, std::move(start)});
    DescriptorFile file{descriptor};
    point_based::write_flat_model(file, model);
    const auto model_bytes = file.place();
    const LeftOut<Model> left_out;
    for (std::uint32_t number = 0; number < space_.size(); ++number) {
      file.write(Model::save_state(left_out.rest_of(space_[number])));
      file.write("\n");
    }
    if (!file.flush()) throw std::runtime_error("the listing cannot be written");
    json.begin_object().member("model_bytes", static_cast<std::uint64_t>(model_bytes));
    json.key("observations").values(space_.observations().texts());
    left_out.write_names(json.key("left_out"));
    json.end_object();
  }

 private:
  // Memory is the only limit here, since no decision waits for the listing.
  static ListLimits limits(std::size_t max_states) {
    constexpr std::size_t any = std::numeric_limits<std::size_t>::max();
    return {.states = max_states, .bytes = any, .outcomes = any, .work = any};
  }

  Belief<Model> belief_;
  StateSpace<Model> space_;
};

}
