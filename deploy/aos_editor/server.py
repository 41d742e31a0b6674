"""The language server itself: pygls speaks the protocol, `checking` and `documents` give the answers."""

import asyncio
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path
from pygls.workspace import PositionCodec, ServerTextPosition

from aos_editor.checking import check_folder, end_column, lines_of
from aos_editor.documents import Entry, meaning_at, outline, proposals_at
from aos_editor.highlighting import TOKEN_KINDS, tokens_of
from aos_editor.navigation import Lines, definition, encoded, quick_fixes, references, renamed
from aos_editor.symbols import Bundle, Occurrence, UnrenamableError, files_of, read_bundle
from aos_protocol import __version__
from aos_protocol.diagnostics import Diagnostic, Severity

DEBOUNCE_S = 0.2
"""A bundle is checked this long after the last key stroke."""

_SEVERITIES = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.REMARK: types.DiagnosticSeverity.Information,
}
_KINDS = {
    "define_type": types.SymbolKind.Struct,
    "state_variable": types.SymbolKind.Variable,
    "local_variable": types.SymbolKind.Variable,
    "action_parameter": types.SymbolKind.Constant,
    "mission_parameter": types.SymbolKind.Constant,
    "constant": types.SymbolKind.Constant,
    "parameter": types.SymbolKind.Field,
    "variable": types.SymbolKind.Field,
    "response": types.SymbolKind.EnumMember,
}


class _Name(msgspec.Struct, frozen=True):
    at: Occurrence
    folder: Path
    bundle: Bundle
    lines: Lines


class BundleServer(LanguageServer):
    """Keeps the findings of every folder with an open document current in the editor."""

    def __init__(self) -> None:
        super().__init__("aos", __version__)
        self._pending: dict[Path, asyncio.TimerHandle] = {}
        self._files_with_findings: dict[Path, set[str]] = {}
        self._found: dict[str, list[Diagnostic]] = {}

    def check_soon(self, uri: str) -> None:
        """Checks the document's bundle once nothing has changed in it for a moment."""
        path = _path(uri)
        if path is None:
            return
        if pending := self._pending.pop(path.parent, None):
            pending.cancel()
        loop = asyncio.get_running_loop()
        self._pending[path.parent] = loop.call_later(DEBOUNCE_S, self._check, path.parent)

    def text_of(self, uri: str) -> tuple[str, str, list[str]]:
        """A document's file name, text and lines, newlines as the readers see them."""
        document = self.workspace.get_text_document(uri)
        text = document.source.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
        return Path(document.path).name, text, text.split("\n")

    @property
    def codec(self) -> PositionCodec:
        """The translator between columns in characters and in the editor's units."""
        return self.workspace.position_codec

    def found_in(self, uri: str) -> list[Diagnostic]:
        """The latest findings about a document."""
        path = _path(uri)
        return self._found.get(from_fs_path(str(path)) or "", []) if path is not None else []

    def bundle_of(self, uri: str) -> tuple[Path, Bundle, Lines] | None:
        """The bundle that a document is in, with its folder and the lines of its files."""
        path = _path(uri)
        if path is None:
            return None
        folder, open_texts = path.parent, dict(self._open_texts(path.parent))

        def lines(file: str) -> list[str]:
            text = open_texts.get(file)
            return lines_of(file, text.encode() if text is not None else (folder / file).read_bytes())

        return folder, read_bundle(folder, open_texts), lines

    def name_at(
        self, params: types.DefinitionParams | types.ReferenceParams | types.RenameParams
    ) -> _Name | None:
        """The name at a position of a document, and the bundle it is in."""
        uri = params.text_document.uri
        if (bundle_of := self.bundle_of(uri)) is None:
            return None
        name, _, lines = self.text_of(uri)
        at = self.codec.position_from_client_units(lines, params.position)
        found = bundle_of[1].at(name, at.line + 1, at.character)
        return None if found is None else _Name(found, *bundle_of)

    def _check(self, folder: Path) -> None:
        self._pending.pop(folder, None)
        open_texts = dict(self._open_texts(folder))
        checked = check_folder(folder, open_texts) if open_texts else {}
        with_findings = {name for name, (_, found) in checked.items() if found}
        for name in sorted(with_findings | self._files_with_findings.get(folder, set())):
            lines, found = checked.get(name, ([""], []))
            items = [_diagnostic(diagnostic, lines, self.codec) for diagnostic in found]
            uri = from_fs_path(str(folder / name))
            if uri is not None:
                self._found[uri] = found
                self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, items))
        self._files_with_findings[folder] = with_findings

    def _open_texts(self, folder: Path) -> Iterator[tuple[str, str]]:
        for document in self.workspace.text_documents.values():
            path = _path(document.uri)
            if path is not None and path.parent == folder:
                yield path.name, document.source


def language_server() -> BundleServer:
    """A server with its features, ready for `start_io`."""
    server = BundleServer()

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def edited(
        params: types.DidOpenTextDocumentParams
        | types.DidChangeTextDocumentParams
        | types.DidSaveTextDocumentParams
        | types.DidCloseTextDocumentParams,
    ) -> None:
        server.check_soon(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(params: types.HoverParams) -> types.Hover | None:
        name, text, lines = server.text_of(params.text_document.uri)
        at = server.codec.position_from_client_units(lines, params.position)
        found = meaning_at(name, text, at.line + 1, at.character)
        if found is None:
            return None
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, f"`{found[0]}` {found[1]}"))

    @server.feature(
        types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=[".", "_", ":"])
    )
    def complete(params: types.CompletionParams) -> list[types.CompletionItem]:
        name, text, lines = server.text_of(params.text_document.uri)
        at = server.codec.position_from_client_units(lines, params.position)
        items = []
        for rank, proposal in enumerate(proposals_at(name, text, at.line + 1, at.character)):
            replaced = _range(
                lines, at.line, at.character - proposal.replaced, at.line, at.character, server.codec
            )
            item = types.CompletionItem(
                proposal.label,
                documentation=types.MarkupContent(types.MarkupKind.Markdown, proposal.meaning),
                kind=types.CompletionItemKind.Keyword,
                sort_text=f"{rank:03}",
                text_edit=types.TextEdit(replaced, proposal.text),
            )
            items.append(item)
        return items

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def symbols(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        name, text, lines = server.text_of(params.text_document.uri)
        return [_symbol(entry, lines, server.codec) for entry in outline(name, text)]

    _add_navigation(server)
    return server


def _add_navigation(server: BundleServer) -> None:
    """Adds the features that cross the files of a bundle, colours, and quick fixes."""

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def go_to_definition(params: types.DefinitionParams) -> types.Location | None:
        name = server.name_at(params)
        if name is None:
            return None
        return definition(name.bundle, name.at, name.folder, name.lines, server.codec)

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def find_references(params: types.ReferenceParams) -> list[types.Location]:
        name = server.name_at(params)
        if name is None:
            return []
        declares = params.context.include_declaration
        return references(name.bundle, name.at, name.folder, name.lines, server.codec, declares=declares)

    @server.feature(types.TEXT_DOCUMENT_RENAME)
    def rename(params: types.RenameParams) -> types.WorkspaceEdit:
        name = server.name_at(params)
        if name is None:
            raise JsonRpcInvalidParams("no name of the bundle stands here")
        try:
            return renamed(name.bundle, name.at, params.new_name, name.folder, name.lines, server.codec)
        except UnrenamableError as error:
            raise JsonRpcInvalidParams(str(error)) from None

    @server.feature(
        types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, types.SemanticTokensLegend(list(TOKEN_KINDS), [])
    )
    def colours(params: types.SemanticTokensParams) -> types.SemanticTokens:
        uri = params.text_document.uri
        name, text, lines = server.text_of(uri)
        bundle_of = server.bundle_of(uri)
        occurrences = files_of(bundle_of[1].occurrences).get(name, []) if bundle_of is not None else []
        return encoded(tokens_of(name, text, occurrences), lines, server.codec)

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions([types.CodeActionKind.QuickFix]))
    def fix(params: types.CodeActionParams) -> list[types.CodeAction]:
        uri = params.text_document.uri
        _, _, lines = server.text_of(uri)
        return quick_fixes(server.found_in(uri), params.range, uri, lines, server.codec)


def _path(uri: str) -> Path | None:
    """The file of a URI; None for texts that are in no file yet."""
    path = to_fs_path(uri) if uri.startswith("file:") else None
    return Path(path) if path else None


def _diagnostic(found: Diagnostic, lines: Sequence[str], codec: PositionCodec) -> types.Diagnostic:
    line = min(max(found.span.line, 1), len(lines)) - 1
    column = min(max(found.span.column, 1) - 1, len(lines[line]))
    end = end_column(lines[line], column) if found.span.column else len(lines[line])
    return types.Diagnostic(
        _range(lines, line, column, line, min(end, len(lines[line])), codec),
        f"{found.message}. {found.hint}" if found.hint else found.message,
        _SEVERITIES[found.severity],
        found.code,
        source="aos",
    )


def _symbol(entry: Entry, lines: Sequence[str], codec: PositionCodec) -> types.DocumentSymbol:
    line, column = entry.line - 1, entry.column - 1
    last = min(entry.last_line, len(lines)) - 1
    return types.DocumentSymbol(
        entry.title,
        _KINDS.get(entry.word, types.SymbolKind.Property),
        _range(lines, line, column, last, len(lines[last]), codec),
        _range(lines, line, column, line, len(lines[line]), codec),
        detail=entry.word,
        children=[_symbol(part, lines, codec) for part in entry.parts],
    )


def _range(
    lines: Sequence[str], line: int, column: int, end_line: int, end: int, codec: PositionCodec
) -> types.Range:
    return types.Range(
        codec.position_to_client_units(lines, ServerTextPosition(line, column)),
        codec.position_to_client_units(lines, ServerTextPosition(end_line, end)),
    )
