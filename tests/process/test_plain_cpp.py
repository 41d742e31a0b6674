import pytest
from mappings import mapping_text
from models import engine_of_text

ENVIRONMENT = """project: odd
horizon: 2
discount: 0.9

define_type: Chosen
enum_members: Red, Blue

define_type: Response
enum_members: Missed, Observed

define_type: Parameters
variable: int weight 2
variable: int marks [] {1}

state_variable: Chosen colour
code:
state.colour = Blue;

state_variable: int row []
code:
state.row = {3, 1, 2};

state_variable: int other []
code:
state.other = {8, 7};

state_variable: int last []
code:
state.last = {5, 6, 5, 4};

state_variable: vector<vector<int>> grid
code:
state.grid = {{1, 2}, {3, 4}};

state_variable: vector<bool> flags
code:
state.flags = {true, false, true};

state_variable: std::pair<int, int> spot
code:
state.spot = {2, 5};

state_variable: set<pair<int, int>> kept
code:
state.kept = {{3, 1}, {1, 2}, {3, 1}};

state_variable: std::unordered_map<Chosen, set<int>> sorted

state_variable: string note

state_variable: map<int, int> stock
code:
state.stock = {{1, 5}, {4, 6}};

state_variable: map<string, int> price
code:
state.price = {{"a", 4}};

state_variable: Parameters first

state_variable: Parameters second

state_variable: Parameters third

reward_code:
int sum = 0;
for (int& value : state.row) sum += value;
for (auto& box : state.ParametersObjects) sum += box->weight;
Parameters& box = state.first;
int* last = &state.row[2];
if (sum + box.weight + *last != 16) __reward = -1000;
"""
CODE = {
    "copy": ("auto copy = state.row; copy.push_back(1); __reward = copy.size();", 4),
    "choice": (
        "auto copy = state.colour == Red ? state.other : state.row; copy.push_back(1);"
        "__reward = copy.size();",
        4,
    ),
    "member": (
        "auto m = &Parameters::weight; state__.third.*m += 3; __reward = state__.third.*m;"
        "state__.third = state.third;",
        5,
    ),
    "rows": ("for (auto line : state.grid) { line.push_back(5); __reward += line[2]; }", 10),
    "captured": ("auto next = [&, n = amount]() mutable { return n++; }; next(); __reward = next();", 4),
    "bound": (
        "std::function<void(vector<int>&)> add = [&](vector<int>& row) { row.push_back(9); };"
        "add(state__.row); __reward = state__.row.back(); state__.row.pop_back();",
        9,
    ),
    "lent": (
        "auto raise = [&](int by, const vector<int>& row) { state__.row[0] += by; return row[0]; };"
        "auto sum = [](const vector<int>& all) { return all[0] + all[1]; };"
        "auto& row = state__.row; auto set = [&](const vector<int>& all) { row[2] = 5; return all[2]; };"
        "auto longer = [&](const vector<int>& all) { auto copy = all; copy.push_back(1); return copy; };"
        "auto both = [&](const vector<int>& all) { return set(all) + all[1]; };"
        "__reward = raise(amount, state__.row) + 10 * sum({1, 2}) + sum(row) + both(row);"
        "__reward += 100 * longer(row).size(); state__.row = state.row;",
        3 + 3 + 30 + 7 + 6 + 400,
    ),
    "stream": ('std::stringstream text("4 5"); int a, b; text >> a >> b; __reward = a + b;', 9),
    "flags": (
        "state__.flags[1].flip(); state__.flags.flip(); vector<bool> mine{true, true}; mine[1].flip();"
        "__reward = state__.flags[1] + 2 * state.flags[0] + 4 * mine[1]; state__.flags = state.flags;",
        2,
    ),
    "texts": (
        'std::istringstream in("4 six"), parts("ab;c"); in >> state__.row[0] >> state__.note;'
        "__reward = state__.note.find_first_of('x') + 10 * state__.note.append(3, 'x').size();"
        "auto& note = state__.note; std::getline(parts, state__.note, ';');"
        "note.erase(std::remove(note.begin(), note.end(), 'a'), note.end());"
        '__reward += 100 * state.row[0] + (note == "b"); state__.row = state.row;',
        2 + 60 + 300 + 1,
    ),
    "lists": (
        "state__.grid.emplace_back(2, 5); __reward = state__.grid[2].size() * 10 + state__.grid[2][0];"
        "state__.last.swap(state__.other); __reward += 100 * state__.last.size();"
        "state__.last.swap(state__.other); std::pair<int, int> spot{9, 9}; std::swap(state__.spot, spot);"
        "__reward += spot.first; state__.spot = spot; state__.grid = state.grid;",
        20 + 5 + 200 + 2,
    ),
    "order": ("__reward = state.row < state.other && state.row >= vector<int>{1, 2};", 1),
    "then": ("auto then = state; then.third.weight = 5; __reward = then.third.weight;", 5),
    "caught": (
        "try { __reward = state.row.at(amount); } catch (const std::out_of_range&) { __reward = 5; }",
        5,
    ),
    "everything": (
        "int x = 0; try { while (x == 0) x = AOSUtils::SampleDiscrete(std::vector<double>{0.5, 0.25, 0.25});"
        "if (x == 2) throw 1; } catch (...) { x = 9; } __reward = x;",
        5,
    ),
    "names": ("Response seen = Observed; __reward = 5 + seen;", 6),
    "either": (
        "auto& one = amount > 2 ? state__.last : state__.row; one[0] = 8;"
        "std::swap(state__.last, state__.row);"
        "for (auto* list : {&state__.last, &state__.row}) __reward += (*list)[0] * list->size();"
        "std::swap(state__.last, state__.row); state__.last = state.last;",
        8 * 4 + 3 * 3,
    ),
    "taken": (
        "vector<int> mine{7}; std::swap(mine, state__.other); mine.swap(state__.other);"
        "std::vector<int>* all = &mine; std::erase(*all, 7);"
        "auto copy = state.row; std::erase_if(copy, [](int n) { return n < 3; });"
        "vector<int>* list = &state__.other; __reward = list->size() * 10 + copy.size() + all->size();",
        21,
    ),
    "sorted": (
        "auto [x, y] = state.spot; state__.sorted[Red] = {y, x, y}; state__.kept.emplace(9, amount);"
        "std::set<std::pair<int, int>> mine = state__.kept; mine.erase({3, 1});"
        "for (const auto& [key, values] : state__.sorted) __reward += 10 * values.size() + *values.begin();"
        "std::pair<int, int> spot{1, 2}; bool is_kept = state.kept.find(spot) != state.kept.end();"
        "if (is_kept && !state__.sorted.count(Blue)) __reward += mine.size();"
        "state__.kept = state.kept; state__.kept.erase(spot); __reward += 100 * (state__.kept < state.kept);"
        "spot = state.spot; __reward += std::get<1>(state.spot) + 1000 * state.kept.contains(state.spot);"
        "try { state__.sorted.at(Blue).insert(1); } catch (const std::out_of_range& told) "
        '{ __reward += 0.5 * (std::string(told.what()).find("map") == 2); }',
        20 + 2 + 2 + 0 + 5 + 0.5,
    ),
    "asked": (
        "Parameters* both[2] = {&state.first, &state.second}; for (Parameters* each : both)"
        '__reward += each->weight; __reward += state__.price["a"] + state.price["z"];',
        8,
    ),
    "found": (
        "auto at = state__.stock.find(4); at->second += amount;"
        "auto [low, high] = state__.stock.equal_range(1);"
        "for (auto it = low; it != high; ++it) it->second = 0;"
        "auto [old, is_new] = state__.stock.try_emplace(4, 1);"
        "__reward = old->second + 10 * is_new + 100 * (state__.stock.upper_bound(1) == at);"
        "for (const auto& [key, value] : state__.stock) __reward += value;",
        9 + 100 + 9,
    ),
    "merged": (
        "std::map<int, int> more{{4, 1}, {7, 2}}; state__.stock.merge(more);"
        "auto all = state.ParametersObjects;"
        "__reward = 10 * state__.stock.size() + more.size() + (*state.ParametersObjects.rbegin())->weight +"
        "std::count_if(all.begin(), all.end(), [](auto& box) { return box->weight == 2; });"
        "for (auto&& box : state.ParametersObjects) __reward += box->weight; state__.stock = state.stock;",
        30 + 1 + 2 + 3 + 6,
    ),
    "views": (
        "for (int key : std::ranges::views::keys(state.stock)) __reward += key;"
        "for (int& value : state__.stock | std::views::values) value *= 2;"
        "auto node = state__.stock.extract(4); node.key() = 2; state__.stock.insert(std::move(node));"
        "auto [at, is_new] = state__.stock.insert_or_assign(1, 7); __reward += 10 * is_new + at->second;"
        'vector<string> texts{"a", "bc"}; state__.note = "d"; state__.note.swap(texts[1]);'
        'std::erase(texts, "a"); __reward += texts.size() + 100 * (state__.note == "bc");'
        "__reward += state__.stock.at(2); state__.stock = state.stock;",
        5 + 7 + 1 + 100 + 12,
    ),
    "held": (
        "vector<int>* all[2] = {&state__.row, &state__.other}; vector<int>& one = *all[1]; one.push_back(1);"
        "std::map<int, std::vector<int>*> by; by[4] = &state__.last; vector<int>* none = nullptr, *mine;"
        "mine = all[0]; if (!none) none = &state__.row; const vector<int>* fixed[] = {&state.row};"
        "auto pick = [&](int n) -> vector<int>& { return n > 2 ? state__.last : state__.row; };"
        "pick(amount)[0] = 9; for (vector<int>* each : all) __reward += each->size();"
        "std::string* text = nullptr; text = &state__.note; *text += 'x'; state__.note = state.note;"
        "__reward += 10 * by[4]->front() + none->size() + mine->size() + fixed[0]->size();"
        "state__.other = state.other; state__.last = state.last;",
        6 + 90 + 9,
    ),
    "within": (
        "const int* most = nullptr; vector<int>* marks = NULL; for (auto box : state__.ParametersObjects) {"
        "if (!most || box->weight > *most) most = &box->weight; if (box->weight == 2) marks = &box->marks; }"
        "const vector<int>* first = nullptr; first = &state.ParametersObjects[0]->marks;"
        "marks->push_back(amount); __reward = *most + 10 * state__.third.marks.size() + first->front();"
        "state__.third = state.third;",
        2 + 20 + 1,
    ),
    "seen": (
        "const vector<int>& row = state__.row; state__.row[0] = 8; const string& note = state__.note;"
        'state__.note = "ab"; for (const vector<int>& line : state__.grid) { state__.grid[1][0] = 7;'
        "__reward = __reward * 10 + line[0]; } __reward += 100 * row[0] + 1000 * note.size();"
        "state__.row = state.row; state__.note = state.note; state__.grid = state.grid;",
        17 + 800 + 2000,
    ),
    "values": (
        "vector<Chosen> all = state.ChosenObjects, none; auto more = all; more = state.ChosenObjects;"
        "auto last = state.ChosenObjects; last.push_back(Red);"
        "auto count = [](const vector<Chosen>& some) { return some.size(); }; none = state.ChosenObjects;"
        "__reward = count(state.ChosenObjects) + 10 * last.size() + 100 * (none == more);",
        2 + 30 + 100,
    ),
    "method": (
        "struct Half { int n; Half(int m) : n(m / 2) {} }; static int const four = 4; Half half(amount);"
        "int most(std::max(amount, half.n)); __reward = half.n * four + most;",
        7,
    ),
    "headers": (
        "std::any value = 3; std::forward_list<int> list{1, 2}; std::vector<int> sums(3);"
        "std::valarray<int> all{3}; char digit[1]; std::to_chars(digit, digit + 1, 7);"
        "std::inclusive_scan(state.row.begin(), state.row.end(), sums.begin());"
        "auto large = state.row | std::views::filter([](int n) { return n > 1; });"
        "__reward = std::any_cast<int>(value) + sums[2] + std::ranges::distance(large) + list.front()"
        "+ all[0] + digit[0] - '7';",
        15,
    ),
}
"""Code, and the reward that a compiler of plain C++ gives it; the amount is 3."""
SKILL = """project: odd
parameter: int amount

available_parameters_code:
__possibleParameters.push_back(std::make_tuple(3));

dynamic_model:
{code}
__moduleResponse = done;
"""


async def test_code_means_what_it_means_in_plain_cpp():
    files = {"odd.ef": ENVIRONMENT}
    for name, (code, _) in CODE.items():
        files[f"{name}.sd"] = SKILL.format(code=code)
    async with engine_of_text(files) as engine:
        values = await engine.exact_values(horizon=1)
    rewards = {value.action.split("(")[0]: value.q for value in values.values}
    assert rewards == {name: pytest.approx(reward) for name, (_, reward) in CODE.items()}


DOOR = """project: door
horizon: 1
discount: 0.9

define_type: Locals
enum_members: open, closed

state_variable: Locals door
code:
state.door = closed;

state_variable: int pulls [Locals]
default_value: 0

reward_code:
if (state.pulls[open] == 2) __reward = 100;
"""
PULL = """project: door

precondition:
__meetPrecondition = state.door != open;
violate_penalty: -5

dynamic_model:
if (AOS.Bernoulli(0.5)) state__.door = state.door == closed ? open : closed;
switch (state__.door) {
    case open: state__.pulls[open] += 2; break;
    default: __reward = std::count(state.LocalsObjects.begin(), state.LocalsObjects.end(), closed);
}
auto is_open = [](Locals door) { Locals wanted = open; return door == wanted && wanted == open; };
int said = closed;
if (is_open(state__.door)) said = open;
__moduleResponse = said;
"""


async def test_a_name_is_the_enums_value_where_no_response_can_stand():
    pull = mapping_text(
        "open: is_open", "closed: True", project="door", skill="pull", reports={"is_open": "bool"}
    )
    files = {"door.ef": DOOR, "pull.sd": PULL, "pull.am": pull}
    async with engine_of_text(files) as engine:
        values = await engine.exact_values()
        update = await engine.update("pull", "open")
    assert values.values[0].q == pytest.approx(0.5 * 100 + 0.5 * 1)
    assert update.probability == pytest.approx(0.5)
    assert update.summary.marginals[0].values == {"open": pytest.approx(1)}
