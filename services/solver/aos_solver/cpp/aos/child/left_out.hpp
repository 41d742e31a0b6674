// States without the variables on which neither rewards nor observations depend. These variables get the
// values of one initial state, so that states which differ in nothing else are equal.
#pragma once

#include "aos/draws/random.hpp"
#include "aos/model/values.hpp"
#include "aos/text/json.hpp"

namespace aos {

template <class Model>
class LeftOut {
 public:
  using State = typename Model::State;

  LeftOut() : stand_in_(some_state()), places_(all_places()) {
    erase_if(places_, [](const Place& place) { return !is_irrelevant(place); });
  }

  State rest_of(const State& state) const {
    State rest = state;
    for (const auto& [name, offset, size] : places_) {
      std::memcpy(Model::bytes_of(rest) + offset, Model::bytes_of(stand_in_) + offset, size);
    }
    return rest;
  }

  void write_names(JsonWriter& json) const {
    json.begin_array();
    for (const Place& place : places_) json.value(place.name);
    json.end_array();
  }

 private:
  // A part of a state with a meaning of its own: a single value, or the members of one compound.
  struct Place {
    std::string name;
    std::size_t offset;
    std::size_t size;
  };

  List<Place> all_places() const {
    List<Place> places;
    std::string compound;
    NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) {
      const auto offset = static_cast<std::size_t>(static_cast<const std::byte*>(leaf.place) - Model::bytes_of(stand_in_));
      const auto dot = name.rfind('.');
      const std::string owner = dot == std::string::npos ? "" : name.substr(0, dot);
      if (!owner.empty() && owner == compound) places.back().size = offset + leaf.size - places.back().offset;
      else places.push_back({owner.empty() ? name : owner, offset, leaf.size});
      compound = owner;
    }};
    Model::visit_values(stand_in_, leaves);
    return places;
  }

  // An initial state, always the same one.
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
  List<Place> places_;
};

}
