// States without the variables that change neither what is earned nor what is observed: those have the values of one
// initial state, so that states which differ in nothing else are equal.
#pragma once

#include <algorithm>
#include <vector>

#include "aos/base/json.hpp"
#include "aos/base/random.hpp"
#include "aos/model/values.hpp"

namespace aos {

template <class Model>
class LeftOut {
 public:
  using State = typename Model::State;

  LeftOut() : stand_in_(some_state()) {
    for (const Place& place : Model::places(stand_in_)) {
      if (is_irrelevant(place)) places_.push_back(place);
    }
  }

  State rest_of(const State& state) const {
    State rest = state;
    for (const Place& place : places_) copy_place<Model>(place, stand_in_, rest);
    return rest;
  }

  void write_names(JsonWriter& json) const {
    json.begin_array();
    for (const Place& place : places_) json.value(place.name);
    json.end_array();
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
  std::vector<Place> places_;
};

}  // namespace aos
