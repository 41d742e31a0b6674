// States without the variables that somebody who solves a model leaves out, since they change neither what is earned nor
// what is observed: those have the values of one initial state, so that states which differ in nothing else are equal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/json.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/child/bad_command.hpp"
#include "aos/model/values.hpp"

namespace aos {

template <class Model>
class LeftOut {
 public:
  using State = typename Model::State;

  // Of the model's places these numbers, which are the same in each engine of the model. Throws BadCommand.
  explicit LeftOut(const std::vector<std::size_t>& numbers = {}) : stand_in_(some_state()) {
    if (numbers.empty()) return;
    const std::vector<Place> places = Model::places(stand_in_);
    for (const std::size_t number : numbers) {
      if (number >= places.size()) throw BadCommand{"there is no such variable"};
      left_out_.push_back(places[number]);
    }
  }

  State rest_of(const State& state) const {
    State rest = state;
    for (const Place& place : left_out_) copy_place(place, stand_in_, rest);
    return rest;
  }

  // Tells the numbers and names of what does not matter.
  static void tell_proposal(JsonWriter& json) {
    const std::vector<Place> places = Model::places(some_state());
    json.begin_object().key("variables").begin_array();
    for (std::size_t number = 0; number < places.size(); ++number) {
      if (!is_irrelevant(places[number])) continue;
      json.begin_object().member("number", number).member("name", places[number].name).end_object();
    }
    json.end_array().end_object();
  }

 private:
  // Always the same one.
  static State some_state() {
    Sampler random{1};
    State state{};
    Model::initial(state, random);
    return state;
  }

  static bool is_irrelevant(const Place& place) {
    return std::ranges::any_of(Model::irrelevant(), [&](const ByteRange& range) {
      return range.offset <= place.offset && place.offset + place.size <= range.offset + range.size;
    });
  }

  State stand_in_;
  std::vector<Place> left_out_;
};

}  // namespace aos
