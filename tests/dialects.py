from collections.abc import Mapping

from projects import files_project
from texts import encoded

from aos_language.convert import Dialect, convert, without_origins


def converted(files: Mapping[str, bytes], dialect: Dialect) -> dict[str, bytes]:
    """The documents in a dialect, in which all of them can be said."""
    texts, findings = convert(files, dialect)
    assert texts, findings
    assert not any(finding.is_error for finding in findings), findings
    return encoded(texts)


def say_the_same(files: Mapping[str, bytes]) -> tuple[dict[str, bytes], dict[str, bytes]]:
    """Holds the documents of all dialects against each other; those in JSON and in SDL."""
    original = without_origins(files_project(files))
    sdl, json = converted(files, Dialect.SDL), converted(files, Dialect.JSON)
    papers = {
        name: data.replace(b'"PlpMain"', b'"GsdlMain"').replace(b'"PLP"', b'"GSDL"')
        for name, data in json.items()
    }
    for other in (sdl, json, papers, converted(json, Dialect.SDL), converted(sdl, Dialect.JSON)):
        assert without_origins(files_project(other)) == original
    assert converted(sdl, Dialect.SDL) == sdl == converted(json, Dialect.SDL)
    return json, sdl
