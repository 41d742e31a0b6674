import re

import pytest
from lint_texts import ENVIRONMENT, MAPPING, SKILL, finding_texts, found, skill_after
from texts import encoded

from aos_language.load import load_files
from aos_protocol.diagnostics import Severity


def test_the_bundle_itself_is_clean():
    assert finding_texts() == []


def test_lines_of_code_that_begin_with_a_word_of_the_grammar_stay_code():
    mapping = MAPPING.replace("local_variable: steps", "local_variable: path").replace(
        "code:\nsteps", "code:\npath"
    )
    assert finding_texts(mapping=mapping) == []
    skill = skill_after("int parameter = 1;\nparameter = 2;")
    assert finding_texts(skill=skill) == []


@pytest.mark.parametrize(
    ("declared", "code", "hint"),
    [
        ("int k = 3", "AOS104", "Write `default_value: 3` on a line of its own"),
        ("int k [5]", "AOS104", "Write `array<int, 5> k`"),
        ("int k, m", "AOS104", "Write a line for each"),
        ("int k;", "AOS127", "It is skipped"),
    ],
)
def test_a_declaration_as_cpp_writes_it_is_told_how_sdl_does(declared, code, hint):
    told = found(environment=f"{ENVIRONMENT}\nstate_variable: {declared}\n")
    assert [(each.code, each.hint) for each in told if each.code != "AOS133"] == [(code, hint)]


def test_a_word_of_no_section_in_code_is_told_as_the_label_that_cpp_takes_it_for():
    label, condition = "goal:\n", "if (state.first.x == 2) __isGoalState = true;\n"
    told = finding_texts(environment=f"{ENVIRONMENT}\n{label}{condition}")
    assert any("AOS108 `goal:` is a label in C++. No section has this word" in each for each in told)
    again = "int i = 0;\nagain:\nif (++i < 3) goto again;\n"
    assert not any("AOS108" in each for each in finding_texts(environment=f"{ENVIRONMENT}\n{again}"))


@pytest.mark.parametrize("comment", ["# the door is open", "    #the door's open"])
def test_a_comment_of_python_in_cpp_is_told_what_to_write(comment):
    for code in (f"{comment}\n__moduleResponse", f"int n = 1; {comment}\n__moduleResponse"):
        (only,) = found(skill=SKILL.replace("__moduleResponse", code))
        assert (only.code, only.hint) == ("AOS108", "Write `//` instead")
        assert (only.mend.length, only.mend.text) == (1, "//")


@pytest.mark.parametrize(
    ("text", "written", "meant"),
    [
        (("environment", "__isGoalState", "isGoalState"), "isGoalState", "__isGoalState"),
        (("environment", "__isGoalState", "__isGoalStat"), "__isGoalStat", "__isGoalState"),
        (("environment", "int x 0", "bool x False"), "False", "false"),
        (("skill", "__moduleResponse", "response"), "response", "__moduleResponse"),
        (("skill", "__moduleResponse", "__observation"), "__observation", "__moduleResponse"),
        (("environment", "__isGoalState", "__goal"), "__goal", "__isGoalState"),
        (("skill", "__moduleResponse", "_moduleResponse"), "_moduleResponse", "__moduleResponse"),
        (("skill", "__meetPrecondition", "meetPrecondition"), "meetPrecondition", "__meetPrecondition"),
    ],
)
def test_a_name_of_the_language_without_its_underscores_is_recognized(text, written, meant):
    document, before, after = text
    whole = {"environment": ENVIRONMENT, "skill": SKILL}[document]
    errors = [finding for finding in found(**{document: whole.replace(before, after)}) if finding.is_error]
    assert [(error.message, error.hint) for error in errors] == [
        (f"unknown name `{written}`", f"Did you mean `{meant}`?")
    ]
    assert errors[0].mend.text == meant


def test_a_statement_that_only_compares_is_told_with_the_sign_that_was_meant():
    skill = SKILL.replace("state__.second.x =", "if (steps == 1) __reward = 1;\nstate__.second.x ==")
    (only,) = found(skill=skill)
    assert (only.code, only.span.line, only.span.column) == ("AOS149", 10, 18)
    assert (only.mend.length, only.mend.text) == (2, "=")
    code = "steps == 1 ? void(__reward = 1) : void();\n__reward == steps > 0 ? 1 : 2;"
    (only,) = found(skill=skill_after(code))
    assert (only.code, only.span.line, only.span.column) == ("AOS149", 10, 10)


@pytest.mark.parametrize(
    ("before", "name", "told"),
    [
        ("state.first.x = AOS", "__reward", "there is no `__reward` in the initial belief"),
        ("if (state.second", "__moduleResponse", "there is no `__moduleResponse` in a special state"),
        ("__meetPrecondition", "__reward", "there is no `__reward` in the precondition"),
        ("state__.second.x =", "__isGoalState", "there is no `__isGoalState` in the dynamic model"),
    ],
)
def test_a_name_of_the_language_in_another_section_is_told_with_those_that_have_it(before, name, told):
    texts = {
        key: text.replace(before, f"{name} = 0;\n{before}")
        for key, text in (("environment", ENVIRONMENT), ("skill", SKILL))
    }
    (only,) = found(**texts)
    assert (only.code, only.message) == ("AOS110", told)
    assert only.hint.startswith("Only ")


@pytest.mark.parametrize(
    ("code", "column"),
    [
        ("if (state__.second.x = 2) __reward = 1;", 22),
        ("int n = 0; while (n = 1) n++;", 21),
        ("int n = 0; do n++; while (n = 1);", 29),
        ("int n = 0; for (; n = 1;) n++;", 21),
        ("int n = 0; __reward = (n = 1) ? 2 : 3;", 26),
    ],
)
def test_a_condition_that_sets_is_told_with_the_sign_that_was_meant(code, column):
    (only,) = found(skill=skill_after(code))
    assert (only.code, only.span.line, only.span.column) == ("AOS149", 9, column)
    assert (only.mend.length, only.mend.text) == (1, "==")


def test_the_condition_of_a_loop_over_variables_that_sets_is_told():
    loop = "assignment:\nloop_next: Cell each\nloop_condition: each.x = 1\nloop_body:\n__reward = 1;\n"
    (only,) = found(skill=SKILL.replace("dynamic_model:\n", f"dynamic_model:\n{loop}assignment:\ncode:\n"))
    assert (only.code, only.span.line, only.span.column) == ("AOS149", 11, 24)


def test_a_condition_that_sets_in_brackets_of_its_own_is_meant_so():
    code = "int n = 0; if ((n = steps)) __reward = n; while ((n = n - 1) > 0) n--;"
    assert found(skill=skill_after(code)) == ()


@pytest.mark.parametrize(
    "code",
    [
        "for (int i :\n {1, 2}) __reward += i;",
        "// if the door is open:\n__reward = 1;",
        "switch (steps) { case 1: __reward = 1; break; default: __reward = 2; }",
        "for (int i = 0, n = 3; i < n; i++, n--) __reward += i;",
        'const char* text = R"(\nif it rains:\n)"; __reward = text[0];',
    ],
)
def test_code_of_cpp_is_no_python_and_no_decimal(code):
    assert finding_texts(skill=skill_after(code)) == []


def test_a_penalty_above_0_is_told_at_its_number():
    (only,) = found(skill=SKILL.replace("violate_penalty: -1", "violate_penalty: 2.5"))
    assert (only.span.line, only.span.column) == (6, 18)
    assert str(only.message) == "walk earns 2.5 where its precondition does not hold"
    assert only.hint == "A penalty is added to the reward: write -2.5"


def test_a_draw_that_would_make_actions_is_told():
    code = "if (AOS.Bernoulli(0.4)) __possibleParameters.push_back(std::make_tuple(1));"
    listing = f"\navailable_parameters_code:\n{code}\n"
    drawn = "\naction_parameter: int near\ncode:\nstate.near = AOS.SampleUniform(0, 9);\n"
    for place in ({"skill": SKILL + listing}, {"environment": ENVIRONMENT + drawn}):
        assert [told for told in finding_texts(**place) if "AOS124 actions are made once, from the" in told]
    initial = ENVIRONMENT + "\nstate_variable: int far\ncode:\nstate.far = AOS.SampleUniform(0, 9);\n"
    assert not [told for told in finding_texts(environment=initial) if "AOS124" in told]


def test_a_skill_that_may_always_be_used_needs_no_penalty():
    skill = SKILL.replace("violate_penalty: -1\n", "")
    assert any("AOS147" in told for told in finding_texts(skill=skill))
    always = re.sub(r"__meetPrecondition = .*", "__meetPrecondition = true;", skill)
    assert not any("AOS147" in told for told in finding_texts(skill=always))


def test_own_variables_may_be_called_like_names_of_the_language_without_underscores():
    skill = SKILL.replace("__moduleResponse", "int reward = 0;\nreward += 1;\n__moduleResponse")
    assert finding_texts(skill=skill) == []


def test_names_may_begin_with_underscores():
    environment = ENVIRONMENT.replace(
        "initial_belief:\n",
        "initial_belief:\nassignment:\ntemporary_variable: int __S\ncode:\n__S = 1;\nassignment:\ncode:\n",
    ).replace("AOS.Bernoulli(0.5) ? 1", "AOS.Bernoulli(0.5) ? __S")
    assert finding_texts(environment=environment) == []


def test_a_mission_without_a_goal_is_remarked():
    (only,) = found(environment=ENVIRONMENT.replace("__isGoalState = true; ", ""))
    assert (only.code, only.severity) == ("AOS139", Severity.REMARK)


@pytest.mark.parametrize("reward", ["__reward = -10;", "__reward -= 3;", ""])
def test_endings_that_are_all_penalised_are_a_warning(reward):
    findings = found(environment=ENVIRONMENT.replace("__reward = 10;", reward))
    assert [finding.severity for finding in findings if finding.code == "AOS139"] == [Severity.WARNING]


def test_an_ending_that_a_skill_may_pay_for_is_remarked():
    environment = ENVIRONMENT.replace("__reward = 10;", "")
    findings = found(environment=environment, skill=SKILL + "__reward = 10;\n")
    assert [finding.severity for finding in findings if finding.code == "AOS139"] == [Severity.REMARK]


@pytest.mark.parametrize("reward", ["__reward += 3;", "__reward = near;", "__isFailureState = false;"])
def test_an_ending_that_may_be_a_goal_is_none(reward):
    environment = ENVIRONMENT.replace("__reward = 10;", reward.replace("near", "state.near"))
    assert "AOS139" not in [finding.code for finding in found(environment=environment)]


def test_a_parameter_that_the_mapping_never_passes_on_is_told():
    mapping = MAPPING.partition("parameter:")[0]
    (only,) = found(mapping=mapping)
    assert (only.code, only.severity, only.span.file, only.span.line) == (
        "AOS140",
        Severity.WARNING,
        "walk.sd",
        2,
    )


def test_defaults_that_set_the_same_element_are_told():
    both = ENVIRONMENT.replace("state.second.x = 2;", "state.second.x = 2;\nstate.first.x = 3;")
    (only,) = finding_texts(environment=both)
    assert only.startswith("14 AOS141 the defaults of first and second both set `state.first.x`")
    copied = ENVIRONMENT.replace("state.second.x = 2;", "state.first.x = 2;")
    (only,) = finding_texts(environment=copied)
    assert only.startswith("13 AOS141 the default of second sets `state.first.x`, and not the variable")
    early = ENVIRONMENT.replace("state.first.x = 1", "state.first.x = state.second.x + 1")
    (only,) = finding_texts(environment=early)
    assert only.endswith("reads `state.second.x` before that has its own. Declare first below second")


def test_what_only_looks_at_the_state_may_not_change_it_where_the_copies_are_one_either():
    skill = SKILL.replace("__meetPrecondition = state.first.x > 0", "state.first.x = 1")
    one = ENVIRONMENT.replace("horizon: 4", "horizon: 4\none_state_model: true")
    for environment in (ENVIRONMENT, one):
        assert [finding.code for finding in found(environment=environment, skill=skill)] == ["AOS123"]


@pytest.mark.parametrize(
    ("statement", "line", "name"),
    [
        ('state__.first.is_wet = "false";', 10, "state__.first.is_wet"),
        ('state__.marked[1] = "yes";', 10, "state__.marked[]"),
        ('__isGoalState = "true";', 28, "__isGoalState"),
    ],
)
def test_a_text_is_no_truth_although_the_compiler_takes_it(statement, line, name):
    environment = ENVIRONMENT.replace("variable: int x 0", "variable: int x 0\nvariable: bool is_wet false")
    environment = environment.replace(
        "initial_belief:",
        "state_variable: bool marked []\ncode:\nstate.marked = {true, false};\n\ninitial_belief:",
    )
    skill = SKILL
    if name.startswith("state"):
        skill = SKILL.replace("__moduleResponse", f"{statement}\n__moduleResponse")
    else:
        environment = environment.replace("__isGoalState = true;", statement)
    (told,) = (text for text in finding_texts(environment=environment, skill=skill) if "AOS106" in text)
    expected = (
        f"AOS106 `{name}` is true or false, and this is a text. Write `true` or `false`, without quotes"
    )
    assert told.partition(" ")[2] == expected
    assert told.startswith(f"{line} ")


EXTRINSIC = "\nextrinsic_code:\nif (pour != NULL && AOS.Bernoulli(0.5)) state_.second.x = 1;\n"


def test_a_skill_that_was_left_out_counts_as_never_chosen():
    (only,) = found(environment=ENVIRONMENT + EXTRINSIC)
    assert (only.code, only.severity, only.message) == (
        "AOS110",
        Severity.WARNING,
        "there is no skill `pour`",
    )
    assert only.hint == "It counts as one that is never chosen"
    misspelt = EXTRINSIC.replace("pour", "wlak")
    assert found(environment=ENVIRONMENT + misspelt)[0].hint == "Did you mean `walk`?"


def test_parameters_of_a_skill_that_was_left_out_are_an_error_where_they_may_be_read():
    looking = EXTRINSIC.replace("AOS.Bernoulli(0.5)", "pour->cups > 1")
    assert [finding.severity for finding in found(environment=ENVIRONMENT + looking)] == [Severity.WARNING]
    (read,) = found(environment=ENVIRONMENT + "\nextrinsic_code:\nstate_.second.x += pour->cups;\n")
    assert (read.severity, read.hint) == (
        Severity.ERROR,
        "Read it where `pour != NULL` holds: `if (pour != NULL) ...`",
    )
    unread = {"hall.ef": ENVIRONMENT + looking, "walk.sd": SKILL, "walk.am": MAPPING, "pour.sd": ""}
    assert [finding.code for finding in load_files(encoded(unread)).diagnostics] == ["AOS104"]
    for leaving in ("if (pour == NULL) return;", "if (!pour) { return; }"):
        (only,) = found(environment=f"{ENVIRONMENT}\nextrinsic_code:\n{leaving}\nstate_.second.x += pour->n;")
        assert only.severity == Severity.WARNING
    pointer = "\nextrinsic_code:\nCell* cell = NULL;\nif (cell == NULL) state_.second.x = 1;\n"
    assert found(environment=ENVIRONMENT + pointer) == ()


@pytest.mark.parametrize(
    ("written", "message", "right"),
    [
        ("Bernoulli(0.1)", "unknown function `Bernoulli`", "AOS.Bernoulli"),
        ("Bernouli(0.1)", "unknown function `Bernouli`", "AOS.Bernoulli"),
        ("SampleNormal(0, 1)", "unknown function `SampleNormal`", "AOS.SampleNormal"),
        ("sample_discrete({0.5, 0.5})", "unknown function `sample_discrete`", "AOS.SampleDiscrete"),
        ("IsInitialized(steps)", "unknown function `IsInitialized`", "AOS.IsInitialized"),
        ("AOS::Bernoulli(0.1)", "`AOS::Bernoulli` is not how AOS writes it", "AOS.Bernoulli"),
        ("aos.bernoulli(0.1)", "unknown name `aos`", "AOS.Bernoulli"),
    ],
)
def test_a_draw_that_is_not_written_as_aos_writes_it_is_told_with_the_right_words(written, message, right):
    (only,) = found(skill=SKILL.replace("state.second.x + steps", f"steps + {written}"))
    assert (only.severity, only.code, only.message) == (Severity.ERROR, "AOS110", message)
    assert (only.span.line, only.span.column, only.hint) == (9, 28, f"Write `{right}`")
    assert only.mend.text == right


@pytest.mark.parametrize("wrong", ["'ab'", "''", '"far', "(1", "1 # one"])
def test_a_misspelt_draw_is_told_beside_what_keeps_its_code_from_being_read(wrong):
    text = f"AOS.Bernouli(0.1) /* AOS.Bern(1) */;\nstate__.second.x = {wrong}"
    findings = found(skill=SKILL.replace("state.second.x + steps", text))
    assert [finding.code for finding in findings] == ["AOS110", "AOS108"]
    assert findings[0].hint == "Did you mean `Bernoulli`?"
    assert (findings[0].span.line, findings[0].mend.text) == (9, "Bernoulli")


def test_a_draw_that_is_written_as_the_emitted_model_writes_it_is_told_how_documents_do():
    (only,) = found(skill=SKILL.replace("state.second.x + steps", "AOS.SampleDiscrete<Side>({0.5, 0.5})"))
    assert (only.code, only.message) == ("AOS110", "`AOS.SampleDiscrete<Side>` is not how documents write it")
    assert only.hint == "Write `AOS.SampleDiscrete(Side, {weights})`"
    assert only.mend.text == "AOS.SampleDiscrete(Side, "


@pytest.mark.parametrize("given", ["3, {0.5, 0.5}", "0.5, 0.5, 1", "{near, near}, {0.5, 0.5}", ""])
def test_draws_of_neither_an_enum_nor_values_are_told(given):
    (only,) = found(skill=SKILL.replace("state.second.x + steps", f"AOS.SampleDiscrete({given})"))
    assert only.message == "SampleDiscrete takes an enum or values, and a list of weights"


@pytest.mark.parametrize(
    "code",
    [
        "auto Bernoulli = [](double p) { return AOS.Bernoulli(p); };\nsteps + Bernoulli(0.1)",
        "double draw = AOSUtils::Bernoulli(0.5) + AOSUtils.Bernoulli(0.5);\nsteps + draw",
        "double level = sqrt(2.0) + round(1.5) + std::max(1, 2);\nsteps + level",
    ],
)
def test_functions_of_ones_own_and_of_cpp_are_left_alone(code):
    before, value = code.split("\n")
    changed = f"{before}\nstate__.second.x = {value}"
    assert finding_texts(skill=SKILL.replace("state__.second.x = state.second.x + steps", changed)) == []


def test_a_model_that_never_says_what_comes_back_is_told_with_what_to_add():
    """A warning: AOS 1.x plans with such a skill, and its belief follows what the action does."""
    silent = SKILL.replace("__moduleResponse = walked;\n", "")
    (only,) = finding_texts(skill=silent)
    assert not found(skill=silent)[0].is_error
    message = "the dynamic model of walk never sets __moduleResponse, so that every response is impossible"
    assert only == f"9 AOS117 {message}. Add `__moduleResponse = walked;`"
    (nothing,) = finding_texts(skill=SKILL.partition("state__.second.x")[0])
    assert message in nothing


def test_a_text_that_the_model_never_gives_is_told_too():
    text = "response_local_variable: steps\n"
    mapping = MAPPING.replace("response: walked\nresponse_rule: True\n", text)
    skill = SKILL.replace("__moduleResponse = walked;\n", "")
    (only,) = finding_texts(mapping=mapping, skill=skill)
    assert only.startswith("9 AOS117 the dynamic model of walk never sets __moduleResponseStr")


@pytest.mark.parametrize("rules", ["", "response: DefaultObservation\nresponse_rule: True\n"])
def test_a_skill_that_observes_nothing_needs_no_response(rules):
    mapping = MAPPING.replace("response: walked\nresponse_rule: True\n", rules)
    errors = found(mapping=mapping, skill=SKILL.replace("__moduleResponse = walked;\n", ""))
    assert [error.message for error in errors if error.is_error] == []


@pytest.mark.parametrize(
    ("code", "hint"),
    [
        ("steps == 1", "Compare it with the name, as in `steps == 'Right'`"),
        ("[0.2, 0.4][steps]", "Compare it with the name, as in `steps == 'Left'`"),
        ("3 if steps == 'Rihgt' else 4", "Did you mean 'Right'?"),
        ("[steps for steps in (1, 2) if steps == 1]", None),
    ],
)
def test_a_mapping_that_takes_an_enum_for_a_number_is_told(code, hint):
    environment = ENVIRONMENT + "\ndefine_type: Side\nenum_members: Left, Right\n"
    skill = SKILL.replace("int steps", "Side steps")
    told = found(
        environment=environment, skill=skill, mapping=MAPPING.replace("code:\nsteps", f"code:\n{code}")
    )
    assert [finding.hint for finding in told if finding.code == "AOS149"] == ([hint] if hint else [])
