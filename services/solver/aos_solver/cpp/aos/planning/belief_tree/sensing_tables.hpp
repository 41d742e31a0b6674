// How probable an observation is after a state, an action and a next state, where observations are too many to list.
//
// The model's code is run `sensing_runs` times along the draws that lead to the next state, with stratified draws of the
// sensors. What the runs report makes a table (observation_tables.hpp). It is an estimate, and serves planning only.
//
// Pieces are taken for independent as long as no draw of a sensor has been found to change two of them. A skill where
// one does has tables of whole texts. Outcomes that give the same in the first runs share a table.
#pragma once

#include "aos/base/mixed.hpp"
#include "aos/planning/belief_tree/belief_tree_constants.hpp"
#include "aos/planning/belief_tree/observation_tables.hpp"
#include "aos/planning/belief_tree/sensed_path.hpp"
#include "aos/planning/belief_tree/sensing_runs.hpp"
#include "aos/planning/listed/state_space.hpp"

namespace aos {

template <class Model>
class SensingTables {
 public:
  explicit SensingTables(const StateSpace<Model>& space) : space_(space), runs_(space) {}

  // Drops what does not fit the space any longer.
  void prepare() {
    if (restarts_ != space_.numbering().restarts) forget();
    restarts_ = space_.numbering().restarts;
    table_of_.resize(space_.rows().outcomes.elements.size(), no_table);
    whole_.resize(Model::skill_count);
  }

  // Drops everything, so that what follows does not depend on what came before.
  void forget() {
    forget_tables();
    tables_ = {};
    kinds_.clear();
    whole_.assign(whole_.size(), false);
    symbols_.clear();
  }

  // How many steps of the model were run so far.
  std::uint64_t runs() const { return runs_.count(); }
  // Changes whenever tables have changed their numbers.
  std::uint64_t version() const { return version_; }
  double unknown_share() const { return tables_.unknown_share(); }

  void fill(std::size_t row) {
    const auto& rows = space_.rows().outcomes;
    for (std::size_t outcome = rows.first[row]; outcome < rows.first[row + 1]; ++outcome) table(row, outcome);
  }

  // The table of an outcome, by its place among all outcomes.
  std::uint32_t table(std::size_t row, std::size_t outcome) {
    if (table_of_[outcome] == no_table) tabulate(row);
    return table_of_[outcome];
  }

  void draw(std::uint32_t table, Sampler& random, TabledObservation& drawn) const { tables_.draw(table, random, drawn); }
  double likelihood(std::uint32_t table, const TabledObservation& seen) const { return tables_.likelihood(table, seen); }

 private:
  using Report = SensedPath::Report;
  static constexpr std::uint32_t no_table = 0xffffffffu;

  void tabulate(std::size_t row) {
    const int action = static_cast<int>(row % space_.actions());
    skill_ = Model::skill_of(action);
    runs_.list(static_cast<std::uint32_t>(row / space_.actions()), action);
    const auto& rows = space_.rows().outcomes;
    std::uint64_t version = 0;
    do {  // again where a table has told that texts are not parted
      if (tables_.size() > max_sensing_tables) forget_tables();
      version = version_;
      for (std::size_t outcome = rows.first[row]; outcome < rows.first[row + 1] && version == version_; ++outcome) {
        runs_.lead_to(rows.elements[outcome].next);
        table_of_[outcome] = table_of_runs();
      }
    } while (version != version_);
  }

  // The table of the runs to a next state. It is of no use if the version has changed.
  std::uint32_t table_of_runs() {
    reports_.clear();
    for (std::size_t i = 0; i < compared_runs; ++i) add_run(i);
    const std::uint64_t hash = hash_of(numbered());
    if (const auto known = by_reports_.find(hash); known != by_reports_.end()) return known->second;
    if (!whole_[skill_] && runs_.has_joint_pieces()) {
      whole_[skill_] = true;
      forget_tables();
      return no_table;
    }
    for (std::size_t i = compared_runs; i < sensing_runs; ++i) add_run(i);
    return by_reports_[hash] = tables_.add(numbered());
  }

  void add_run(std::size_t number) {
    std::optional<Report> report = runs_.run(number);
    if (!report) return;
    if (whole_[skill_] && report->pieces.size() > 1) {
      for (std::size_t i = 1; i < report->pieces.size(); ++i) report->pieces[0] += report->pieces[i];
      report->pieces.resize(1);
    }
    reports_.push_back(std::move(*report));
  }

  List<NumberedReport> numbered() {
    List<NumberedReport> result;
    for (const Report& report : reports_) {
      NumberedReport& numbers = result.emplace_back();
      numbers.kind = kind_of(report);
      for (const std::string& piece : report.pieces) numbers.symbols.push_back(symbol_of(piece));
      for (const auto& [name, distribution] : report.numbers) numbers.distributions.push_back(tables_.number_of(distribution));
    }
    return result;
  }
  // The number of a piece of the skill's texts.
  std::uint32_t symbol_of(const std::string& piece) {
    return symbols_.try_emplace(std::to_string(skill_) + "=" + piece, static_cast<std::uint32_t>(symbols_.size())).first->second;
  }
  std::uint32_t kind_of(const Report& report) {
    List<std::uint64_t> key{static_cast<std::uint64_t>(report.response), report.pieces.size()};
    for (const auto& [name, distribution] : report.numbers) key.push_back(name);
    return kinds_.try_emplace(std::move(key), static_cast<std::uint32_t>(kinds_.size())).first->second;
  }
  static std::uint64_t hash_of(const List<NumberedReport>& reports) {
    List<std::uint64_t> key;
    for (const NumberedReport& report : reports) {
      key.push_back(report.kind);
      key.insert(key.end(), report.symbols.begin(), report.symbols.end());
      key.insert(key.end(), report.distributions.begin(), report.distributions.end());
    }
    return NumbersHash{}(key);
  }

  void forget_tables() {
    ++version_;
    std::fill(table_of_.begin(), table_of_.end(), no_table);
    tables_.clear();
    by_reports_.clear();
  }

  const StateSpace<Model>& space_;
  SensingRuns<Model> runs_;
  std::uint64_t restarts_ = 0;
  std::uint64_t version_ = 0;
  List<std::uint32_t> table_of_;  // by outcome
  std::vector<bool> whole_;              // by skill: texts are not parted
  ObservationTables tables_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_reports_;  // by a hash of the first ones
  std::unordered_map<List<std::uint64_t>, std::uint32_t, NumbersHash> kinds_;
  std::unordered_map<std::string, std::uint32_t> symbols_;  // pieces

  int skill_ = 0;  // whose reports these are
  List<Report> reports_;
};

}
