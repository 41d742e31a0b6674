import pytest
from projects import text_project
from scripted_models import ScriptedModel, scripted

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
variable: int sizes[] {4, 5}
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

state_variable: tItem[] rest
code:
tItem item;
item.counts = {3, 1};   // project: no section
state.rest.push_back(item);
state_variable: vector<bool> ready
code:
state.ready = {true, false};

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
if (shift) return;
if (poke != nullptr && poke->kind == kScrew && AOS.Bernoulli(0.1)) state_.shaken += 1;
for (auto* it : state_.tItemObjects) if (it->done && AOS.Bernoulli(.05)) it->done = false;

reward_code:
auto is_done = [](const tItem* item) { return item->done; };
if (std::all_of(state.tItemObjects.begin(), state.tItemObjects.end(), is_done)) {
    __reward = 50; __isGoalState = true;
}

reward_code:
switch (state.shaken) {
case 9: __reward = 7; break;
default:
    return;
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
    "shift.sd": """project: test
parameter: tWeight load
parameter: std::string hand

available_parameters_code:
string hands[] = {"left", "right"};
tWeight heavy; heavy.kilograms = 2; heavy.of = kPlate;
for (auto kind : state.eKindObjects)
    for (const auto& hand : hands)
        if (kind == kNut) __possibleParameters.push_back(std::make_tuple(heavy, hand));

precondition: __meetPrecondition = std::any_of(state.tItemObjects.begin(), state.tItemObjects.end(),
    [&](const tItem* item) { return item->weight.of == load.of; }) and not state.names.empty();
if (hand == "left") return;
__meetPrecondition = false;
violate_penalty: -4

dynamic_model:
tItem* found = nullptr;
for (int i = 0; i < (int)state__.tItemObjects.size() && found == NULL; i++)
    if (state__.tItemObjects[i]->weight.of != load.of) found = state__.tItemObjects[i];
auto longest = std::max_element(state__.tItemObjects.begin(), state__.tItemObjects.end(),
    [](tItem* a, tItem* b) { return a->counts.size() < b->counts.size(); });
(*longest)->weight = load;
if (tItem* near = state__.tItemObjects[1]) near->rank = min((double)near->rank, DBL_MAX) + (found == near);
vector<int>& row = state__.grid[0];
vector<int> gates = {6, 7, 8};
row.insert(row.begin() + 1, gates.begin(), gates.end());
row.erase(remove_if(row.begin(), row.end(), [](int n) { return n == 7; }), row.end());
vector<int>::iterator first = state__.grid[0].begin(); *first = 3;
auto& same = row; vector<int>::iterator named = same.begin(); *named += 1;
const auto& seen_only = state__.grid[0]; std::vector<int>::const_iterator read = seen_only.begin();
for (auto& grid_row : state__.grid) { std::vector<int>::const_iterator at = grid_row.begin(); (void)*at; }
std::swap(row[1], row[2]);
std::vector<int> turned = row; std::reverse(turned.begin(), turned.end()); state__.grid[1] = turned;
std::set<int> seen(row.begin(), row.end());
vector<int> both; set_union(seen.begin(), seen.end(), gates.begin(), gates.end(), back_inserter(both));
std::map<std::string, std::vector<int>> groups;
for (size_t i = 0; i < state.ratios.size(); i++) groups[state.item1.label].push_back(i);
std::pair<int, double> best(0, -1.0); typedef std::pair<int, int> Spot; std::set<Spot> spots{Spot(1, 2)};
for (auto it = state__.ratios.begin(); it != state__.ratios.end(); ++it)
    if ((*it += 0.5) > best.second) best = {3, *it};
for (vector<tItem>::iterator it = state__.rest.begin(); it != state__.rest.end(); ++it)
    for (int& n : it->counts) { n = (n + 1) % 4; }
state__.ready[1] = state__.ready[0] || state.ready[1]; state__.item1.done ^= true;
const vector<double> odds(2, 1.0 / 2);
unique_ptr<int> owned(new int(max(AOSUtils::SampleDiscrete(odds), 0)));
ostringstream out;
out << hand << ":" << load.of << "x" << std::count(row.begin(), row.end(), -1);
string& label = state__.item2.label;
label = out.str();
string key = label + "-" + std::to_string(*owned);
if (label.rfind(hand, 0) == 0 && label.find_first_of("0123456789") != string::npos) label = key;
else label.clear();
if (state.item2.label.find_last_not_of("?") == 2 && state.item2.label.back() == '?')
    label = string(state.item2.label.rbegin(), state.item2.label.rend()) + state.item2.label.front();
__reward = -fabs(best.second) - 10 * (int)both.size() - 100 * (int)groups["one"].size() - 1000 * spots.size();
__moduleResponseStr = out.str();
if (__moduleResponseStr.size() > 6) __moduleResponseStr[0] = toupper(__moduleResponseStr[0]);
""",
}


@pytest.fixture(scope="module")
def bench() -> ScriptedModel:
    return scripted(text_project(BENCH))


def test_code_of_many_kinds_does_what_it_says(bench: ScriptedModel):
    assert bench.walk(500)["steps"] == 500
    played = bench.play("poke(kind=screw)|0 1", initial="2 0 1")
    state = played.steps[0]["state"]
    assert played.initial["state"]["item1.weight.of"] == "kPlate"
    assert [state[f"item1.counts[{index}]"] for index in range(4)] == [str(8 + 1 - 5), "2", "3", "1"]
    assert [state["small"], state["letter"], state["ratios[1]"]] == ["6", str(ord("a")), "0.25"]
    assert state["item1.rank"] == str(7 << 33)
    assert [state["names[0]"], state["mask"], state["grid[1][0]"]] == ["y", str((1 << 40) + 1), "2"]
    assert [state["left"], state["shaken"], state["item1.done"]] == [str(3 + 20 + 400 + 1000), "0", "true"]
    assert (played.rewards, played.observations) == ([-1 - 4 - 5], ["yes"])


def test_parameters_containers_and_texts_are_what_cpp_makes_of_them(bench: ScriptedModel):
    shifts = [f"shift(load={{kilograms=2, of=kPlate}}, hand={hand})" for hand in ("left", "right")]
    assert [name for name in bench.describe() if name.startswith("shift")] == shifts
    played = bench.play(f"{shifts[0]}|1", f"{shifts[1]}|0", initial="2 0 1")
    assert [step["meets_precondition"] for step in played.steps] == [True, False]
    state = played.steps[0]["state"]
    assert [state[f"grid[0][{index}]"] for index in range(5)] == ["4", "8", "6", "-1", "-1"]
    assert [state[f"grid[1][{index}]"] for index in range(5)] == ["-1", "-1", "6", "8", "4"]
    assert [state["rest[0].counts[0]"], state["rest[0].counts[1]"], state["ready[1]"]] == ["0", "2", "true"]
    assert [state["item1.weight.kilograms"], state["item1.done"], state["item2.rank"]] == ["2", "true", "8"]
    assert [state["item1.sizes[1]"], state["item2.label"]] == ["5", "left:2x2-1"]
    assert played.rewards[0] == pytest.approx(-0.8 - 50 - 300 - 1000)
    assert played.observations[0] == "Left:2x2"
