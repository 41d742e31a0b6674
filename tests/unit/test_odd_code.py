"""Model code as a C++ programmer writes it: it compiles, and does what it says."""

from pathlib import Path

from mappings import mapping_text
from scripted_models import scripted, text_project

BENCH = {
    "bench.ef": """project: test
horizon: 6
discount: 0.9

define_type: eKind
enum_members: kScrew, kNut, kPlate

define_type: tWeight
variable: double kilograms 0.5
variable: eKind of kNut

define_type: tItem
variable: string label "none"
variable: tWeight weight
variable: int counts[]
variable: bool done false
variable: unsigned long long rank 7

state_variable: tItem item1
code:
state.item1.label = "one"; state.item1.counts = {1,2,3};

state_variable: tItem item2
code:
{ state.item2.label = std::string("two") + "!"; state.item2.counts.resize(2, 7); }

state_variable: size_t left
state_variable: unsigned int shaken
state_variable: long long mask
code:
state.mask = 1LL << 40;
state_variable: char letter
code:
state.letter = 'q';
state_variable: uint8_t small
state_variable: vector<double> ratios
code:
state.ratios = std::vector<double>(3, 0.3);
state_variable: vector<string> names
code:
state.names = {"x", "y"};
state_variable: vector<vector<int>> grid
code:
state.grid = std::vector<std::vector<int>>(2, std::vector<int>(3, -1));

action_parameter: eKind screw
code:
state.screw = kScrew;
action_parameter: eKind nut
code:
state.nut = kNut;

initial_belief:
vector<float> w {0.2, 0.3, 0.5};
int i = AOSUtils::SampleDiscrete(w);
state.item1.weight.of = static_cast<eKind>(i);
if (AOS.Bernoulli(0.5)) { state.left = 2; }
else if (AOS.Bernoulli(0.25)) { state.left = 1; } else state.left = 0;

extrinsic_code:
if (poke != nullptr && poke->kind == kScrew && AOS.Bernoulli(0.1)) state_.shaken += 1;
for (auto* it : state_.tItemObjects) if (it->done && AOS.Bernoulli(.05)) it->done = false;

reward_code:
auto is_done = [](const tItem* item) { return item->done; };
if (std::all_of(state.tItemObjects.begin(), state.tItemObjects.end(), is_done)) {
    __reward = 50; __isGoalState = true;
}

heuristic_code:
__heuristicValue = count_if(state.tItemObjects.begin(), state.tItemObjects.end(), [](auto t) {
    return t->done;
});
""",
    "poke.sd": """project: test
parameter: eKind kind

precondition:
__meetPrecondition = !(state.item1.done && state.item2.done);
violate_penalty: -3

dynamic_model:
struct Spot { int row; double worth; };
enum class Mode { Fast, Slow };
using Row = std::vector<int>;
typedef double real;
static const int step = 2;
std::function<int(int)> fib = [&](int k) -> int { return k < 2 ? k : fib(k - 1) + fib(k - 2); };
auto [low, high] = std::minmax({state.item1.counts[0], state.item1.counts[1], 5});
std::unordered_map<int, double> odds = {{kScrew, .7}, {kNut, 0.4}};
std::optional<double> p;
if (odds.find(kind) != odds.end()) p = odds[kind];
bool ok = AOS.Bernoulli(p.value_or(0.5));
tItem* target = kind == kScrew ? &state__.item1 : &state__.item2;
if (ok) target->done = true;
target->counts[0] = fib(6) + low - high;
state__.item1.counts.push_back(1);
if (state__.item1.counts.size() > 5) state__.item1.counts.pop_back();
int sum = std::accumulate(state.item1.counts.begin(), state.item1.counts.end(), 0);
state__.small = sum % 7;
target->rank <<= 33;
state__.letter = 'a' + (sum % 3);
for (size_t i = 0; i < state__.ratios.size(); i++) state__.ratios[i] = std::round(state__.ratios[i] * 4) / 4;
std::sort(state__.names.begin(), state__.names.end());
std::reverse(state__.names.begin(), state__.names.end());
state__.mask ^= 1LL;
Spot spot{1, 2.0};
Mode mode = ok ? Mode::Fast : Mode::Slow;
try {
    state__.grid.at(spot.row).at(kind) = step;
    state__.grid.at(spot.row).at(7) = step;
} catch (...) {
    spot.worth *= 2;
}
Row row = state.grid[0];
real mean = std::accumulate(row.begin(), row.end(), 0.0) / row.size();
std::map<std::string, int> ages{{"a", 1}, {"b", 4}};
for (auto& [name, age] : ages) age = std::min(age + 1, 4);
std::set<int> seen{1};
seen.insert(ages["a"]);
int k = 0;
do { k++; if (k == 2) continue; } while (k < 3);
state__.left = k + seen.size() * 10 + ages["b"] * 100 + (mode == Mode::Fast ? 1000 : 2000);
__reward = mean - spot.worth - std::hypot(3.0, 4.0);
switch (kind) { case kScrew: __moduleResponse = ok ? yes : no; break; default: { __moduleResponse = no; } }
""",
    "poke.am": mapping_text("yes", "no"),
}


def test_code_of_many_kinds_does_what_it_says(cache_dir: Path):
    model = scripted(text_project(BENCH), cache_dir)
    assert model.walk(500)["steps"] == 500
    played = model.play("poke(kind=screw)|0 1", initial="2 0 1")
    state = played.steps[0]["state"]
    assert played.initial["state"]["item1.weight.of"] == "kPlate"
    assert [state[f"item1.counts[{index}]"] for index in range(4)] == [str(8 + 1 - 5), "2", "3", "1"]
    assert [state["small"], state["letter"], state["ratios[1]"]] == ["6", str(ord("a")), "0.25"]
    assert state["item1.rank"] == str(7 << 33)
    assert [state["names[0]"], state["mask"], state["grid[1][0]"]] == ["y", str((1 << 40) + 1), "2"]
    assert [state["left"], state["shaken"], state["item1.done"]] == [str(3 + 20 + 400 + 1000), "0", "true"]
    assert (played.rewards, played.observations) == ([-1 - 4 - 5], ["yes"])
