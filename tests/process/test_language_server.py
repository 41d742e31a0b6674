import asyncio
import json
import subprocess
import sys
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import pytest
import pytest_asyncio
from lsprotocol import types
from processes import COMMAND_S, HANG_S
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

from aos_editor.highlighting import TOKEN_KINDS

AOS = Path(sys.executable).parent / "aos"

ENVIRONMENT = """project: lamp
horizon: 3

state_variable: bool is_lit
code:
state.is_lit = false;

reward_code:
if (state.is_lit) { __reward = 1; __isGoalState = true; }
"""
SKILL = """project: lamp

dynamic_model:
state__.is_lit = AOS.Bernoulli(0.9);
__moduleResponse = state__.is_lit ? lit : dark;
__reward = -1;
"""
MAPPING = """project: lamp

response: lit
response_rule: success
response: dark
response_rule: True

module_activation: skill
path: /press

local_variable: success
from_ros_service_response: true
code:
success = __input.success
"""


class Editor(LanguageClient):
    """An editor that keeps the latest findings of each file."""

    def __init__(self):
        super().__init__("test", "1")
        self.published: asyncio.Queue[tuple[str, list[types.Diagnostic]]] = asyncio.Queue()

        @self.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def on_findings(params: types.PublishDiagnosticsParams):
            name = params.uri.rpartition("/")[2]
            self.published.put_nowait((name, list(params.diagnostics)))

    async def findings(self, name: str) -> list[types.Diagnostic]:
        async with asyncio.timeout(HANG_S):
            while True:
                file, found = await self.published.get()
                if file == name:
                    return found

    def open(self, path: Path):
        item = types.TextDocumentItem(path.as_uri(), "aos", 1, path.read_text())
        self.text_document_did_open(types.DidOpenTextDocumentParams(item))

    def change(self, path: Path, text: str):
        document = types.VersionedTextDocumentIdentifier(2, path.as_uri())
        whole = types.TextDocumentContentChangeWholeDocument(text)
        self.text_document_did_change(types.DidChangeTextDocumentParams(document, [whole]))


@pytest.fixture
def bundle(tmp_path) -> Path:
    folder = tmp_path / "lamp"
    folder.mkdir()
    for name, text in (("lamp.ef", ENVIRONMENT), ("press.sd", SKILL), ("press.am", MAPPING)):
        (folder / name).write_text(text)
    return folder


@pytest_asyncio.fixture
async def editor() -> AsyncIterator[Editor]:
    client = Editor()
    await client.start_io(str(AOS), "language-server")
    async with asyncio.timeout(HANG_S):
        await client.initialize_async(types.InitializeParams(types.ClientCapabilities()))
        client.initialized(types.InitializedParams())
        yield client
        await client.shutdown_async(None)
        client.exit(None)
        await client.stop()


async def test_a_mistake_is_shown_at_its_word_and_goes_when_the_text_is_mended_unsaved(
    editor: Editor, bundle: Path
):
    skill = bundle / "press.sd"
    broken = SKILL.replace("state__.is_lit = AOS", "/* 💡 */ state__.is_let = AOS")
    skill.write_text(broken)
    editor.open(skill)
    (found,) = await editor.findings("press.sd")
    assert "is_let" in found.message
    assert found.severity is types.DiagnosticSeverity.Error
    # The lamp counts two units in the editor, and is one character to the linter.
    column = len("/* 💡 */ state__.") + 1
    end = column + len("is_let")
    assert found.range == types.Range(types.Position(3, column), types.Position(3, end))
    editor.change(skill, SKILL)
    assert await editor.findings("press.sd") == []
    assert skill.read_text() == broken


async def test_an_edit_in_one_file_is_checked_against_the_others(editor: Editor, bundle: Path):
    environment = bundle / "lamp.ef"
    editor.open(environment)
    editor.change(environment, ENVIRONMENT.replace("is_lit", "is_on"))
    found = await editor.findings("press.sd")
    assert all("is_lit" in finding.message for finding in found)
    assert {finding.range.start.line for finding in found} == {3, 4}


async def test_words_are_coloured_explained_and_completed_and_sections_listed(editor: Editor, bundle: Path):
    environment, skill = bundle / "lamp.ef", bundle / "press.sd"
    for path, text, expected in (
        (
            skill,
            SKILL,
            {
                ("project", "keyword"),
                ("is_lit", "variable"),
                ("AOS", "macro"),
                ("Bernoulli", "function"),
                ("0.9", "number"),
                ("__reward", "macro"),
                ("lit", "enumMember"),
            },
        ),
        (
            bundle / "press.am",
            MAPPING,
            {("response_rule", "keyword"), ("True", "keyword"), ("success", "variable")},
        ),
    ):
        editor.open(path)
        document = types.TextDocumentIdentifier(path.as_uri())
        tokens = await editor.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document))
        assert tokens is not None
        assert expected <= words_of(tokens.data, text.split("\n"))
    editor.open(environment)
    document = types.TextDocumentIdentifier(skill.as_uri())

    hover = await editor.text_document_hover_async(types.HoverParams(document, types.Position(5, 3)))
    assert hover is not None
    assert isinstance(hover.contents, types.MarkupContent)
    assert hover.contents.value.startswith("`__reward` ")

    editor.change(skill, SKILL + "\npre")
    asked = types.CompletionParams(document, types.Position(7, 3))
    proposed = await editor.text_document_completion_async(asked)
    assert isinstance(proposed, list)
    assert "precondition:" in [item.label for item in proposed]

    symbols = await editor.text_document_document_symbol_async(
        types.DocumentSymbolParams(types.TextDocumentIdentifier(environment.as_uri()))
    )
    assert symbols is not None
    assert [symbol.name for symbol in symbols] == ["lamp", "3", "bool is_lit", "reward_code"]
    assert [child.name for child in symbols[2].children or ()] == ["code"]


def at(path: Path, text: str, word: str, *, nth: int = 0) -> types.TextDocumentPositionParams:
    offset = -1
    for _ in range(nth + 1):
        offset = text.index(word, offset + 1)
    line, column = text.count("\n", 0, offset), offset - (text.rfind("\n", 0, offset) + 1) + 1
    document = types.TextDocumentIdentifier(path.as_uri())
    return types.TextDocumentPositionParams(document, types.Position(line, column))


def place(location: types.Location) -> tuple[str, int, int]:
    start = location.range.start
    return location.uri.rpartition("/")[2], start.line, start.character


async def test_names_lead_to_their_declaration_and_all_their_uses_and_are_renamed_in_all_files(
    editor: Editor, bundle: Path
):
    skill, environment = bundle / "press.sd", bundle / "lamp.ef"
    editor.open(skill)
    asked = at(skill, SKILL, "is_lit")
    found = await editor.text_document_definition_async(
        types.DefinitionParams(asked.text_document, asked.position)
    )
    assert isinstance(found, types.Location)
    assert place(found) == ("lamp.ef", 3, len("state_variable: bool "))
    everywhere = await editor.text_document_references_async(
        types.ReferenceParams(types.ReferenceContext(True), asked.text_document, asked.position)
    )
    assert everywhere is not None
    assert [place(location)[:2] for location in everywhere] == [
        ("lamp.ef", 3),
        ("lamp.ef", 5),
        ("lamp.ef", 8),
        ("press.sd", 3),
        ("press.sd", 4),
    ]
    response = at(skill, SKILL, "lit :")
    found = await editor.text_document_definition_async(
        types.DefinitionParams(response.text_document, response.position)
    )
    assert isinstance(found, types.Location)
    assert place(found) == ("press.am", 2, len("response: "))
    assert environment.read_text() == ENVIRONMENT
    no_names = [(word, "cannot be a name") for word in ("while", "state__", "__reward")]
    for name, reason in (("is_lit", "has a is_lit already"), *no_names):
        with pytest.raises(JsonRpcException, match=reason):
            await editor.text_document_rename_async(
                types.RenameParams(asked.text_document, asked.position, name)
            )
    asked = at(skill, SKILL, "is_lit", nth=1)
    edit = await editor.text_document_rename_async(
        types.RenameParams(asked.text_document, asked.position, "is_on")
    )
    assert edit is not None
    assert edit.changes is not None
    for uri, changes in edit.changes.items():
        path = bundle / uri.rpartition("/")[2]
        lines = path.read_text().split("\n")
        for change in sorted(changes, key=lambda change: -change.range.start.character):
            start, end = change.range.start, change.range.end
            line = lines[start.line]
            lines[start.line] = line[: start.character] + change.new_text + line[end.character :]
        path.write_text("\n".join(lines))
    assert (bundle / "lamp.ef").read_text() == ENVIRONMENT.replace("is_lit", "is_on")
    assert skill.read_text() == SKILL.replace("is_lit", "is_on")
    assert (bundle / "press.am").read_text() == MAPPING


def test_an_editor_that_closes_the_server_gets_exit_code_0():
    asked = [{"id": 1, "method": "initialize", "params": {"capabilities": {}}}]
    asked += [{"id": 2, "method": "shutdown"}, {"method": "exit"}]
    texts = [json.dumps({"jsonrpc": "2.0", **each}) for each in asked]
    sent = "".join(f"Content-Length: {len(text)}\r\n\r\n{text}" for text in texts).encode()
    ended = subprocess.run([AOS, "language-server"], input=sent, capture_output=True, timeout=COMMAND_S)
    assert (ended.returncode, ended.stderr) == (0, b"")


def words_of(data: Sequence[int], lines: list[str]) -> set[tuple[str, str]]:
    words, line, start = set(), 0, 0
    for index in range(0, len(data), 5):
        down, right, length, kind = data[index : index + 4]
        line, start = line + down, right if down else start + right
        words.add((lines[line][start : start + length], TOKEN_KINDS[kind]))
    return words


async def test_a_hint_that_knows_the_mend_is_a_quick_fix(editor: Editor, bundle: Path):
    skill = bundle / "press.sd"
    broken = SKILL.replace("state__.is_lit =", "state__.is_let =")
    skill.write_text(broken)
    editor.open(skill)
    (found,) = await editor.findings("press.sd")
    document = types.TextDocumentIdentifier(skill.as_uri())
    context = types.CodeActionContext([found])
    actions = await editor.text_document_code_action_async(
        types.CodeActionParams(document, found.range, context)
    )
    assert actions is not None
    (action,) = actions
    assert isinstance(action, types.CodeAction)
    assert action.title == "Write `is_lit`"
    assert action.edit is not None
    assert action.edit.changes is not None
    assert [*action.edit.changes[skill.as_uri()]] == [types.TextEdit(found.range, "is_lit")]


async def test_a_folder_without_documents_is_left_alone(editor: Editor, bundle: Path, tmp_path):
    stray = tmp_path / "package.json"
    stray.write_text("{}")
    editor.open(stray)
    skill = bundle / "press.sd"
    skill.write_text(SKILL.replace("lit :", "bright :"))
    editor.open(skill)
    async with asyncio.timeout(HANG_S):
        name, _ = await editor.published.get()
    assert name.startswith("press.")
