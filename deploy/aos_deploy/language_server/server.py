"""The language server itself: pygls speaks the protocol, `checking` and `documents` give the answers."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Sequence
from pathlib import Path

from lsprotocol import types
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path
from pygls.workspace import PositionCodec, ServerTextPosition

from aos_deploy.language_server.checking import check_folder, end_column
from aos_deploy.language_server.documents import Entry, meaning_at, outline, proposals_at
from aos_protocol import __version__
from aos_protocol.diagnostics import Diagnostic, Severity

__all__ = ["language_server"]

DEBOUNCE_S = 0.2
"""How long after the last key stroke a bundle is checked."""

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
    "constant": types.SymbolKind.Constant,
    "parameter": types.SymbolKind.Field,
    "variable": types.SymbolKind.Field,
    "response": types.SymbolKind.EnumMember,
}


class BundleServer(LanguageServer):
    """Keeps the findings of every folder with an open document current in the editor."""

    def __init__(self) -> None:
        super().__init__("aos", __version__)
        self._pending: dict[Path, asyncio.TimerHandle] = {}
        self._told: dict[Path, set[str]] = {}

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
        """Between columns in characters and in the editor's units."""
        return self.workspace.position_codec

    def _check(self, folder: Path) -> None:
        self._pending.pop(folder, None)
        open_texts = dict(self._open_texts(folder))
        checked = check_folder(folder, open_texts) if open_texts else {}
        told = {name for name, (_, found) in checked.items() if found}
        for name in sorted(told | self._told.get(folder, set())):
            lines, found = checked.get(name, ([""], []))
            items = [_diagnostic(each, lines, self.codec) for each in found]
            uri = from_fs_path(str(folder / name))
            if uri is not None:
                self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, items))
        self._told[folder] = told

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

    return server


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
    """Lines and columns from 0, columns in characters."""
    return types.Range(
        codec.position_to_client_units(lines, ServerTextPosition(line, column)),
        codec.position_to_client_units(lines, ServerTextPosition(end_line, end)),
    )
