from aos_language.findings import Findings
from aos_language.reading.sdl_sections import places_of_words
from aos_language.reading.sdl_text import Section, parse_sdl
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import Source
from aos_protocol.diagnostics import Diagnostic


def sections(text: str, suffix: str = ".sd") -> tuple[list[Section], tuple[Diagnostic, ...]]:
    findings = Findings()
    source = Source(f"a{suffix}", text)
    findings.add_source(source.name, source.lines)
    return parse_sdl(source, GRAMMARS[suffix], places_of_words(suffix), findings), findings.sorted()


def code_of(section: Section) -> str:
    snippet = section.code()
    return snippet.code if snippet else ""


def test_a_section_has_a_value_and_a_body_with_places():
    found, findings = sections("project:  p \t\n\ndynamic_model: \n\n  a = 1;\n\n\tb = 2;  \n\n \t")
    project, model = found
    assert (project.word, project.value.text) == ("project", "p")
    snippet = model.code()
    assert snippet.code == "  a = 1;\n\n\tb = 2;"
    assert [str(origin) for origin in snippet.origins] == ["a.sd:5:1", "a.sd:6:1", "a.sd:7:1"]
    assert findings == ()


def test_code_may_begin_on_the_line_of_its_word():
    (section,), _ = sections("precondition: a = 1;\nb = 2;")
    assert code_of(section) == "a = 1;\nb = 2;"
    snippet = section.code()
    assert str(snippet.origins[0]) == "a.sd:1:15"


def test_a_word_inside_code_opens_nothing():
    text = "dynamic_model:\nproject::f();\nswitch (x) {\ncase 1:\ndefault:\n y = a\n  ? b\n  : c; }"
    (section,), findings = sections(text)
    assert code_of(section).count("\n") == 6
    assert findings == ()


def test_words_of_another_case_are_taken_with_a_warning():
    (section,), (warning,) = sections("Dynamic_Model:\nx = 1;")
    assert section.word == "dynamic_model"
    assert (warning.code, str(warning.span), warning.is_error) == ("AOS127", "a.sd:1:1", False)


def test_a_misspelt_word_is_an_error_and_still_opens_its_section():
    (first, second), (error,) = sections("precondition:\nx = 1;\ndynamic_modle:\ny = 2;")
    assert (code_of(first), code_of(second)) == ("x = 1;", "y = 2;")
    assert (error.code, str(error.span), error.hint) == (
        "AOS102",
        "a.sd:3:1",
        "Did you mean `dynamic_model:`?",
    )


def test_a_section_of_another_kind_of_file_is_an_error_that_names_the_kind():
    found, (error,) = sections("dynamic_model:\nx = 1;\nreward_code:\n__reward = 1;")
    assert [code_of(section) for section in found] == ["x = 1;"]
    assert error.hint == "It belongs in the environment file (.ef)"


def test_words_within_a_block_comment_open_nothing():
    text = (
        "/* don't\nprecondition:\n*/\ndynamic_model: /* so\nprecondition: */ x = '\"';  // no /*\n"
        'y = "/*";\nviolate_penalty: -1 /* euros */\n/* one */'
    )
    (model, penalty), findings = sections(text)
    assert code_of(model) == '/* so\nprecondition: */ x = \'"\';  // no /*\ny = "/*";'
    assert (penalty.value.text, findings) == ("-1", ())
    _, (error,) = sections("/* open\nprecondition: x", ".sd")
    assert (error.code, error.message) == ("AOS104", "this comment is never closed")


def test_a_part_in_the_wrong_section_is_an_error_that_names_its_own():
    _, errors = sections("path: /p\nresponse: a\nresponse_rule: True\ntopic: /t\nparameter: x", ".am")
    places = ["`module_activation:`", "`local_variable:`", "`module_activation:`"]
    assert [error.hint for error in errors] == [f"It belongs below {place}" for place in places]
    _, (error,) = sections("module_activation: ros_service\npath: /p\ntype: std_srvs/Trigger", ".am")
    assert error.hint == "The type of a service or action is `srv:`"


def test_the_parts_of_a_section_are_its_own():
    text = (
        "module_activation: skill\nparameter: x\ncode:\na + b\npath: /p\n"
        "local_variable: v\ncode:\nif a:\n    return 1\ntype: bool"
    )
    (activation, variable), findings = sections(text, ".am")
    assert [part.word for part in activation.parts] == ["parameter", "code", "path"]
    assert [part.word for part in variable.parts] == ["code", "type"]
    assert findings == ()


def test_both_spellings_of_the_service_response_are_one_word():
    text = "local_variable: a\nfrom_ros_reservice_response: true\nfrom_ros_service_response: true"
    (variable,), _ = sections(text, ".am")
    assert [part.word for part in variable.parts] == ["from_ros_service_response"] * 2


def test_python_loses_the_indentation_its_lines_share():
    text = "local_variable: v\ncode:\n\t\tif a:\n\t\t    return 1\n\n\t\treturn 2"
    (variable,), _ = sections(text, ".am")
    snippet = variable.parts[0].code()
    assert snippet.code == "if a:\n    return 1\n\nreturn 2"
    assert str(snippet.locate(2, 5)) == "a.am:4:7"
