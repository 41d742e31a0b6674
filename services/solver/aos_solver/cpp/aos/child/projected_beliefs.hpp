// The commands by which a belief goes over to an engine of other variables.
#pragma once

#include "aos/belief/projection.hpp"
#include "aos/child/command.hpp"
#include "aos/child/saved_beliefs.hpp"
#include "aos/text/json.hpp"

namespace aos {

// The variables with these names, apart by commas.
template <class Model>
Members members_named(std::string_view names) {
  Members members;
  if (names.empty()) return members;
  for (const std::string_view name : detail::parts_of(names, ',')) {
    const std::size_t before = members.size();
    for (const Member& member : Model::variables()) {
      if (name == member.name) members.push_back(member);
    }
    if (members.size() == before) throw BadCommand{"there is no variable " + std::string{name}};
  }
  return members;
}

// Writes the joint distribution of some variables, of endings, and of the special states that are spent: from row `first`
// on, as many rows as fit one answer, each as its weight, ending, spent bits and values.
template <class Model>
void save_joint(JsonWriter& json, const Command& command, const Belief<Model>& belief) {
  struct Row {
    double weight;
    Ending ending;
    std::uint64_t spent;
    std::string values;
  };
  const Members members = members_named<Model>(command.text("variables"));
  const auto mask = command.number<std::uint64_t>("spendable");
  List<Row> rows;
  std::unordered_map<std::string, std::size_t> places;
  for (const auto& [state, weight] : belief.particles()) {
    Row row{weight, Model::ending(state), Model::spent(state) & mask, text_of<Model>(members, state)};
    const std::string key = std::to_string(static_cast<int>(row.ending)) + ' ' + std::to_string(row.spent) + ' ' + row.values;
    const auto [place, is_new] = places.try_emplace(key, rows.size());
    if (is_new) rows.push_back(std::move(row));
    else rows[place->second].weight += weight;
  }
  json.begin_object().member("error_bound", belief.error_bound()).member("is_drawn", belief.is_drawn());
  json.member("states", rows.size()).key("rows").begin_array();
  const std::size_t max_bytes = json.text().size() + max_answer_bytes;
  for (auto number = command.number<std::size_t>("first"); number < rows.size() && json.text().size() < max_bytes; ++number) {
    const Row& row = rows[number];
    json.begin_array().value(row.weight).value(static_cast<int>(row.ending));
    json.value(std::to_string(row.spent)).value(row.values).end_array();
  }
  json.end_array().end_object();
}

// Reads what `save_joint` wrote, with the bits of these documents. The items are weight, ending, spent bits and values.
template <class Model>
Belief<Model> load_joint(const Command& command, Sampler& random) {
  const auto& items = command.items();
  List<KnownState> known;
  for (std::size_t item = 0; item + 3 < items.size(); item += 4) {
    const int ending = detail::number_in<int>(items[item + 1]);
    if (ending < 0 || ending >= ending_count) throw BadCommand{"there is no such ending"};
    known.push_back({detail::number_in<double>(items[item]), static_cast<Ending>(ending),
                     detail::number_in<std::uint64_t>(items[item + 2]), items[item + 3]});
  }
  Common common{members_named<Model>(command.text("variables")), members_named<Model>(command.text("fixed")),
                command.number<std::uint64_t>("spendable")};
  const Projection<Model> projection{Belief<Model>::initial(random), std::move(common)};
  return projection.of(known, command.number<double>("error_bound"), command.flag("is_drawn"), random);
}

}
