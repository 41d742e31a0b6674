import copy
import json
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest
from json_values import plain
from places import DATA, DEPLOY, ROOT
from ruamel.yaml import YAML

from aos_deploy.commands.schema import SCHEMAS
from aos_language.findings import Findings
from aos_language.load import load_files
from aos_language.reading.json_document import read_json
from aos_language.reading.json_record import Record
from aos_language.reading.json_text import JsonObject, parse_json
from aos_language.reading.source import Source, open_source

DIALECTS = {"PlpMain": "plp", "GsdlMain": "gsdl"}


def examples() -> dict[str, Any]:
    folder = ROOT / "docs" / "examples" / "kettle-json"
    return {path.name: json.loads(path.read_text(encoding="utf-8")) for path in folder.iterdir()}


def complaints(schema: str, value: Any) -> list[str]:
    validator = jsonschema_rs.Draft202012Validator(SCHEMAS[schema]())
    return [f"{error.kind.name} {error.message}" for error in leaves(validator.iter_errors(value))]


def leaves(errors: Iterable[jsonschema_rs.ValidationError]) -> Iterator[jsonschema_rs.ValidationError]:
    for error in errors:
        branches = getattr(error.kind, "context", ())
        if branches:
            yield from leaves(chain.from_iterable(branches))
        else:
            yield error


@pytest.mark.parametrize("name", SCHEMAS)
def test_the_schema_is_one(name):
    jsonschema_rs.meta.validate(SCHEMAS[name]())


def test_the_examples_of_the_language_page_are_valid():
    documents = examples()
    assert documents
    assert [text for value in documents.values() for text in complaints("plp", value)] == []


def json_documents(*folders: Path) -> Iterator[tuple[str, bytes, Any]]:
    for path in sorted(path for folder in folders for path in folder.glob("*/*.json")):
        source = open_source(path.name, path.read_bytes(), Findings())
        value = parse_json(source, Findings()) if source is not None else None
        if isinstance(value, JsonObject):
            yield path.name, path.read_bytes(), plain(value)


@pytest.mark.corpus
def test_real_documents_are_valid_but_for_keys_that_the_linter_warns_of(corpus: Path):
    checked = 0
    for name, data, value in json_documents(corpus, DATA / "bundles"):
        dialect = next((schema for header, schema in DIALECTS.items() if header in value), None)
        if dialect is None:
            continue
        found = complaints(dialect, value)
        assert all(text.startswith("additionalProperties") for text in found), (name, found)
        warned = [finding for finding in load_files({name: data}).diagnostics if finding.code == "AOS102"]
        assert len(found) == len(warned), (name, found, warned)
        checked += 1
    assert checked > 60


@pytest.mark.parametrize(
    ("document", "before", "after"),
    [
        ("environment.json", '"Horizon"', '"Horizont"'),
        ("environment.json", '"IsGoalState"', '"IsGoal"'),
        ("environment.json", '"Discount": 0.95', '"Discount": 1.5'),
        ("environment.json", '"IsArray": true', '"IsArray": "yes"'),
        ("pour.json", '"DynamicModel"', '"DynamicModell"'),
        ("pour.json", '"ItemName"', '"Item"'),
        ("pour.json", '"PLP"', '"PLPP"'),
        ("pour glue.json", '"ServicePath"', '"Path"'),
        ("pour glue.json", '"ResponseRules": [', '"ResponseRules": [7, '),
        ("environment glue.json", '"InitCode"', '"Code"'),
    ],
)
def test_a_typing_mistake_is_no_valid_document(document, before, after):
    text = json.dumps(examples()[document])
    assert before in text
    assert complaints("plp", json.loads(text.replace(before, after, 1)))


def test_gsdl_documents_have_their_own_header_and_kinds():
    document = examples()["pour.json"]
    head = document.pop("PlpMain")
    assert complaints("gsdl", {"GsdlMain": {**head, "Type": "GSDL"}, **document}) == []
    assert complaints("gsdl", {"GsdlMain": head, **document})


@pytest.mark.parametrize("kind", ["Environment", "PLP", "Glue", "EnvironmentGlue"])
def test_schema_and_reader_know_the_same_keys(kind, monkeypatch):
    known: set[str] = set()
    finish = Record.finish

    def noting(record: Record):
        known.update(record._known)
        finish(record)

    monkeypatch.setattr(Record, "finish", noting)
    full = _full(kind)
    findings = Findings()
    read_json(Source("full.json", json.dumps(full)), findings)
    unknown = [finding.message for finding in findings.sorted() if finding.code == "AOS102"]
    assert [message for message in unknown if "unknown key" in message] == []
    keys = set(_keys(full))
    assert keys <= known
    assert known - keys <= {"GsdlMain", *OBSOLETE}


OBSOLETE = {
    "ModuleResponse",
    "RequiredResources",
    "LocalVariablesInitializationFromGlobalVariables",
    "EnumResponse",
    "Max_concurrent_actions",
    "RosParameter",
}
"""Keys that the linter knows only to say that they have no effect or are not supported."""


def _full(kind: str) -> Any:
    schema = SCHEMAS["plp"]()
    definition = next(
        rule["then"]["$ref"] for rule in schema["allOf"] if kind in json.dumps(rule["if"]).split('"')
    )
    document = _instance({"$ref": definition}, schema)
    document["PlpMain"] |= {"Type": kind, "Name": "full"}
    return document


def _instance(schema: Any, whole: Any) -> Any:
    if "$ref" in schema:
        return _instance(whole["$defs"][schema["$ref"].rpartition("/")[2]], whole)
    if "properties" in schema:
        return {key: _instance(schema_of_key, whole) for key, schema_of_key in schema["properties"].items()}
    if schema.get("type") == "array":
        return [_instance(schema["items"], whole)]
    return {"boolean": True, "number": 1, "integer": 1}.get(str(schema.get("type")), "x")


def _keys(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        yield from value
        for item in value.values():
            yield from _keys(item)
    elif isinstance(value, list):
        for item in value:
            yield from _keys(item)


def deploy_files() -> dict[str, Any]:
    files = sorted((DEPLOY).glob("*.yaml"))
    return {path.name: YAML(typ="safe", pure=True).load(path.read_text()) for path in files}


def test_the_deploy_files_are_valid():
    files = deploy_files()
    assert files
    assert [text for value in files.values() for text in complaints("deploy", value)] == []


@pytest.mark.parametrize(
    "change",
    [
        {"robott": "x"},
        {"bundles": []},
        {"aos": 2},
        {"mission": {"goal_probability": 2}},
        {"mission": {"step_limits": 3}},
        {"solver": {"simulations": 10, "time_s": 1.0}},
        {"bind": {"/pick": 1}},
    ],
)
def test_a_mistake_in_a_deploy_file_is_found(change):
    value = copy.deepcopy(deploy_files()["armadillo.yaml"])
    assert complaints("deploy", {**value, **change})
