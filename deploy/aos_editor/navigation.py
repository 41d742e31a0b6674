"""Definitions, references, renames, colours and quick fixes, in the editor's terms."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from lsprotocol import types
from pygls.uris import from_fs_path
from pygls.workspace import PositionCodec, ServerTextPosition

from aos_editor.highlighting import TOKEN_KINDS, Token
from aos_editor.symbols import Bundle, Occurrence, files_of
from aos_protocol.diagnostics import Diagnostic

Lines = Callable[[str], Sequence[str]]
"""The lines of a file of the bundle, by its name."""


def definition(
    bundle: Bundle, at: Occurrence, folder: Path, lines: Lines, codec: PositionCodec
) -> types.Location | None:
    """Returns the place where the symbol is declared; None where no file declares it."""
    declared = bundle.definition(at.symbol)
    return None if declared is None else _location(declared, folder, lines, codec)


def references(
    bundle: Bundle, at: Occurrence, folder: Path, lines: Lines, codec: PositionCodec, *, declares: bool
) -> list[types.Location]:
    """Returns the places where the symbol stands, with its declaration if that is wanted."""
    found = (occurrence for occurrence in bundle.of(at.symbol) if declares or not occurrence.is_declaration)
    return [
        place for occurrence in found if (place := _location(occurrence, folder, lines, codec)) is not None
    ]


def renamed(
    bundle: Bundle, at: Occurrence, new_name: str, folder: Path, lines: Lines, codec: PositionCodec
) -> types.WorkspaceEdit:
    """The edits in all files; UnrenamableError where the name cannot be."""
    bundle.check_rename(at.symbol, new_name)
    changes: dict[str, list[types.TextEdit]] = {}
    for file, occurrences in files_of(bundle.of(at.symbol)).items():
        uri = from_fs_path(str(folder / file))
        if uri is not None:
            changes[uri] = [
                types.TextEdit(_range(occurrence, lines, codec), new_name) for occurrence in occurrences
            ]
    return types.WorkspaceEdit(changes)


def encoded(tokens: Iterable[Token], lines: Sequence[str], codec: PositionCodec) -> types.SemanticTokens:
    """Tokens as the protocol packs them: each by its distance from the one before."""
    data: list[int] = []
    last_line = last_start = 0
    for token in tokens:
        if token.line > len(lines):
            continue
        start, end = (
            codec.position_to_client_units(lines, ServerTextPosition(token.line - 1, column)).character
            for column in (token.column, token.column + token.length)
        )
        line = token.line - 1
        data += [line - last_line, start - (last_start if line == last_line else 0), end - start]
        data += [TOKEN_KINDS.index(token.kind), 0]
        last_line, last_start = line, start
    return types.SemanticTokens(data)


def quick_fixes(
    found: Iterable[Diagnostic], wanted: types.Range, uri: str, lines: Sequence[str], codec: PositionCodec
) -> list[types.CodeAction]:
    """The mends of findings in a range, for those that have one."""
    actions = []
    for diagnostic in found:
        mend = diagnostic.mend
        if mend is None or not wanted.start.line <= mend.span.line - 1 <= wanted.end.line:
            continue
        place = _between(mend.span.line, mend.span.column, mend.length, lines, codec)
        edit = types.WorkspaceEdit({uri: [types.TextEdit(place, mend.text)]})
        title = f"Write `{mend.text}`" if mend.length else f"Insert `{mend.text}`"
        actions.append(types.CodeAction(title, types.CodeActionKind.QuickFix, edit=edit, is_preferred=True))
    return actions


def _location(at: Occurrence, folder: Path, lines: Lines, codec: PositionCodec) -> types.Location | None:
    uri = from_fs_path(str(folder / at.span.file))
    return None if uri is None else types.Location(uri, _range(at, lines, codec))


def _range(at: Occurrence, lines: Lines, codec: PositionCodec) -> types.Range:
    length = 0 if at.symbol.kind == "skill" and at.is_declaration else len(at.symbol.name)
    return _between(at.span.line, at.span.column, length, lines(at.span.file), codec)


def _between(line: int, column: int, length: int, lines: Sequence[str], codec: PositionCodec) -> types.Range:
    start, end = (
        codec.position_to_client_units(lines, ServerTextPosition(line - 1, at))
        for at in (column - 1, column - 1 + length)
    )
    return types.Range(start, end)
