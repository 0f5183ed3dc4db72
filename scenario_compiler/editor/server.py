"""The language server: translates the protocol's requests and answers to functions of texts.

A text is sent as a whole with each change. It is checked a moment after the last change, in a separate thread, so that
answers do not wait for the check. Offsets are characters; the protocol counts as client and server have agreed.
"""

from __future__ import annotations

import asyncio
import os
import re
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import Protocol

from lsprotocol import types as lsp
from pygls import uris
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.workspace import PositionCodec

from scenario_compiler.diagnostics import CompileError, Severity
from scenario_compiler.editor.analysis import Analysis, Symbol
from scenario_compiler.editor.completion import Offer, OfferKind, offers
from scenario_compiler.editor.draft import Draft, Tag
from scenario_compiler.editor.findings import Finding, Note
from scenario_compiler.editor.hover import explained
from scenario_compiler.editor.layout import layout_edits
from scenario_compiler.editor.naming import CannotRenameError, Occurrence, renaming, uses_of
from scenario_compiler.editor.outline import Entry, outline, scenarios
from scenario_compiler.editor.workspace import Workspace

NAME = "scenario-compiler"

PREVIEW = f"{NAME}.preview"
"""The command of the lens over a scenario; its arguments are the file's URI and the scenario's name."""

AFTER_CHANGE = 0.15
"""Time after the last change at which a text is checked, s."""

SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}

OFFER_KINDS: dict[OfferKind, lsp.CompletionItemKind] = {
    "element": lsp.CompletionItemKind.Class,
    "attribute": lsp.CompletionItemKind.Property,
    "value": lsp.CompletionItemKind.Value,
    "name": lsp.CompletionItemKind.Variable,
    "function": lsp.CompletionItemKind.Function,
    "end": lsp.CompletionItemKind.Class,
}

SYMBOL_KINDS = {
    "scenario": lsp.SymbolKind.Module,
    "template": lsp.SymbolKind.Function,
    "parameter": lsp.SymbolKind.Variable,
    "event": lsp.SymbolKind.Event,
    "part": lsp.SymbolKind.Namespace,
    "spawn_point": lsp.SymbolKind.Constant,
    "vehicle": lsp.SymbolKind.Struct,
    "driver": lsp.SymbolKind.Struct,
}
"""The protocol's symbol kinds for kinds of names; all others are objects."""


class Positioned(Protocol):
    """The parameters of a request about a place in a text."""

    @property
    def text_document(self) -> lsp.TextDocumentIdentifier:
        """The text."""
        ...

    @property
    def position(self) -> lsp.Position:
        """The place in it."""
        ...


class ScenarioServer(LanguageServer):
    """The server of one editor."""

    def __init__(self, maps: Sequence[Path] = ()) -> None:
        """Begin with no open texts; `maps` are folders in which maps are looked for first."""
        super().__init__(NAME, version(NAME), text_document_sync_kind=lsp.TextDocumentSyncKind.Full)
        self.open = Workspace(maps=maps)
        self.checker = ThreadPoolExecutor(1, "check")
        self.waiting: dict[str, asyncio.TimerHandle] = {}
        self.named: dict[str, str] = {}
        self.pictures: tempfile.TemporaryDirectory[str] | None = None

    @property
    def codec(self) -> PositionCodec:
        """The encoding in which the protocol counts positions."""
        return self.workspace.position_codec

    def hold(self, uri: str, text: str) -> None:
        """Store a text that was opened or changed."""
        self.named[os.path.realpath(path_of(uri))] = uri
        self.open.hold(path_of(uri), text)

    def uri(self, path: str) -> str:
        """Return the URI of a file; for an open file it is the one that the editor uses."""
        return self.named.get(os.path.realpath(path)) or uris.from_fs_path(str(Path(path).absolute())) or path

    def position(self, draft: Draft, offset: int) -> lsp.Position:
        """Return the protocol's position of an offset."""
        line = draft.line_of(offset)
        before = draft.text[draft.line_starts[line] : offset]
        return lsp.Position(line, self.codec.client_num_units(before))

    def range(self, draft: Draft, start: int, end: int) -> lsp.Range:
        """Return the protocol's range of a part of a text."""
        return lsp.Range(self.position(draft, start), self.position(draft, end))

    def offset(self, draft: Draft, position: lsp.Position) -> int:
        """Return the offset of a protocol's position."""
        text, units = draft.line_text(position.line), 0
        for column, character in enumerate(text):
            if units >= position.character:
                return draft.offset_at(position.line, column)
            units += self.codec.client_num_units(character)
        return draft.offset_at(position.line, len(text))

    def at(self, params: Positioned) -> tuple[Analysis, int] | None:
        """Return the text and the offset of a request; None if the text's language is not edited word by word."""
        analysis = self.open.words(path_of(params.text_document.uri))
        return None if analysis is None else (analysis, self.offset(analysis.draft, params.position))

    def check_soon(self, uri: str, after: float = AFTER_CHANGE) -> None:
        """Check a text after a short delay, and send the findings to the editor; a change restarts the delay."""
        if uri in self.waiting:
            self.waiting.pop(uri).cancel()
        loop = asyncio.get_running_loop()
        self.waiting[uri] = loop.call_later(after, lambda: loop.create_task(self.check(uri)))

    async def check(self, uri: str) -> None:
        """Check a text, and send the findings to the editor if the text has not changed meanwhile."""
        self.waiting.pop(uri, None)
        path = path_of(uri)
        analysis = self.open.analysis(path)
        if analysis is None:
            return
        found = await asyncio.get_running_loop().run_in_executor(self.checker, self.open.check, path)
        now = self.open.analysis(path)
        if now is not None and now.draft.text == analysis.draft.text:
            self.publish(uri, [self.diagnostic(analysis.draft, one) for one in found])

    def publish(self, uri: str, found: list[lsp.Diagnostic]) -> None:
        """Send a text's findings to the editor."""
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, found))

    def diagnostic(self, draft: Draft, one: Finding) -> lsp.Diagnostic:
        """Return a finding as a diagnostic of the protocol."""
        return lsp.Diagnostic(
            range=self.range(draft, one.start, one.end),
            message=one.message,
            severity=SEVERITIES[one.severity],
            code=one.code,
            source=NAME,
            related_information=[self.related(note) for note in one.notes] or None,
        )

    def related(self, note: Note) -> lsp.DiagnosticRelatedInformation:
        """Return another place of a finding in the protocol's form."""
        start, end = lsp.Position(note.line, note.column), lsp.Position(note.line, note.column + note.length)
        return lsp.DiagnosticRelatedInformation(lsp.Location(self.uri(note.file), lsp.Range(start, end)), note.message)

    def location(self, symbol: Symbol) -> lsp.Location:
        """Return the place of a symbol's declaration."""
        analysis = self.open.analysis(symbol.file)
        if analysis is None:
            start = lsp.Position(max(symbol.line - 1, 0), max(symbol.column - 1, 0))
            end = lsp.Position(start.line, start.character + len(symbol.name))
            return lsp.Location(self.uri(symbol.file), lsp.Range(start, end))
        begin = analysis.draft.offset_at(symbol.line - 1, symbol.column - 1)
        return lsp.Location(self.uri(symbol.file), self.range(analysis.draft, begin, begin + len(symbol.name)))

    def symbol_at(self, params: Positioned) -> Symbol | None:
        """Return the symbol at the place of a request."""
        there = self.at(params)
        mention = None if there is None else there[0].mention_at(there[1])
        return None if mention is None else mention.symbol

    def picture(self, name: str) -> Path:
        """Return the file for a scenario's preview; it exists as long as the server."""
        if self.pictures is None:
            self.pictures = tempfile.TemporaryDirectory(prefix=f"{NAME}-")
        return Path(self.pictures.name, f"{name}.png")


def make_server(maps: Sequence[Path] = ()) -> ScenarioServer:
    """Return a server with all its features."""
    server = ScenarioServer(maps)
    for add in (_add_texts, _add_answers, _add_names, _add_pictures):
        add(server)
    return server


def _add_texts(server: ScenarioServer) -> None:
    @server.feature(lsp.INITIALIZED)
    def initialized(params: lsp.InitializedParams) -> None:
        del params
        folders = (path_of(one.uri) for one in server.workspace.folders.values())
        server.open.folders = [Path(one) for one in folders]

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS)
    def folders_changed(params: lsp.DidChangeWorkspaceFoldersParams) -> None:
        gone = {path_of(one.uri) for one in params.event.removed}
        new = [Path(path_of(one.uri)) for one in params.event.added]
        server.open.folders = [one for one in server.open.folders if str(one) not in gone] + new

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    async def opened(params: lsp.DidOpenTextDocumentParams) -> None:
        server.hold(params.text_document.uri, params.text_document.text)
        server.check_soon(params.text_document.uri, 0.0)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    async def changed(params: lsp.DidChangeTextDocumentParams) -> None:
        uri = params.text_document.uri
        server.hold(uri, server.workspace.get_text_document(uri).source)
        server.check_soon(uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    async def saved(params: lsp.DidSaveTextDocumentParams) -> None:
        server.open.saved(path_of(params.text_document.uri))
        for analysis in list(server.open.texts.values()):
            server.check_soon(server.uri(analysis.path))

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: lsp.DidCloseTextDocumentParams) -> None:
        server.open.let_go(path_of(params.text_document.uri))
        server.publish(params.text_document.uri, [])


def _add_answers(server: ScenarioServer) -> None:
    options = lsp.CompletionOptions(trigger_characters=["<", "/", " ", '"', "'", "$", "{"])

    @server.feature(lsp.TEXT_DOCUMENT_COMPLETION, options)
    def complete(params: lsp.CompletionParams) -> lsp.CompletionList:
        there = server.at(params)
        found = [] if there is None else offers(*there, server.open.maps)
        items = [] if there is None else _items(server, there[0].draft, found)
        return lsp.CompletionList(is_incomplete=False, items=items)

    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hover(params: lsp.HoverParams) -> lsp.Hover | None:
        there = server.at(params)
        found = None if there is None else explained(*there, server.open.maps)
        if there is None or found is None:
            return None
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, found.text)
        return lsp.Hover(content, server.range(there[0].draft, found.start, found.end))

    @server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    def lay_out(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        analysis = server.open.words(path_of(params.text_document.uri))
        if analysis is None:
            return []
        draft = analysis.draft
        return [lsp.TextEdit(server.range(draft, one.start, one.end), one.text) for one in layout_edits(draft)]

    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def symbols(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        analysis = server.open.words(path_of(params.text_document.uri))
        return [] if analysis is None else [_symbol(server, analysis.draft, one) for one in outline(analysis)]


def _items(server: ScenarioServer, draft: Draft, found: Sequence[Offer]) -> list[lsp.CompletionItem]:
    """Return completions in the protocol's form; without places to fill in for a client without snippets."""
    capabilities = server.client_capabilities.text_document
    snippets = getattr(
        getattr(getattr(capabilities, "completion", None), "completion_item", None), "snippet_support", 0
    )
    ranges: dict[tuple[int, int], lsp.Range] = {}
    items = []
    for number, one in enumerate(found):
        where = ranges.setdefault((one.start, one.end), server.range(draft, one.start, one.end))
        items.append(
            lsp.CompletionItem(
                label=one.label,
                kind=OFFER_KINDS[one.kind],
                detail=one.detail or None,
                documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, one.text) if one.text else None,
                sort_text=f"{number:05}",
                filter_text=f"/{one.label[2:]}" if one.kind == "end" else one.label,
                insert_text_format=lsp.InsertTextFormat.Snippet if snippets else lsp.InsertTextFormat.PlainText,
                text_edit=lsp.TextEdit(where, one.insert if snippets else one.plain),
            )
        )
    return items


def _symbol(server: ScenarioServer, draft: Draft, entry: Entry) -> lsp.DocumentSymbol:
    return lsp.DocumentSymbol(
        name=entry.name,
        kind=SYMBOL_KINDS.get(entry.kind, lsp.SymbolKind.Object),
        detail=entry.detail,
        range=server.range(draft, entry.start, entry.end),
        selection_range=server.range(draft, entry.name_start, entry.name_end),
        children=[_symbol(server, draft, one) for one in entry.children],
    )


def _add_names(server: ScenarioServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def definition(params: lsp.DefinitionParams) -> lsp.Location | None:
        symbol = server.symbol_at(params)
        return None if symbol is None else server.location(symbol)

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def references(params: lsp.ReferenceParams) -> list[lsp.Location]:
        symbol = server.symbol_at(params)
        found = [] if symbol is None else uses_of(symbol, server.open.files(symbol))
        wanted = (one for one in found if params.context.include_declaration or not one.mention.declares)
        return [lsp.Location(server.uri(one.analysis.path), _stretch(server, one)) for one in wanted]

    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT)
    def highlights(params: lsp.DocumentHighlightParams) -> list[lsp.DocumentHighlight]:
        there, symbol = server.at(params), server.symbol_at(params)
        found: Iterable[Occurrence] = () if there is None or symbol is None else uses_of(symbol, [there[0]])
        return [lsp.DocumentHighlight(_stretch(server, one)) for one in found]

    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare(params: lsp.PrepareRenameParams) -> lsp.PrepareRenamePlaceholder | None:
        there = server.at(params)
        mention = None if there is None else there[0].mention_at(there[1])
        if there is None or mention is None:
            return None
        where = server.range(there[0].draft, mention.start, mention.end)
        return lsp.PrepareRenamePlaceholder(where, mention.symbol.name)

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def rename(params: lsp.RenameParams) -> lsp.WorkspaceEdit:
        symbol = server.symbol_at(params)
        if symbol is None:
            raise JsonRpcInvalidParams("there is no name here")
        try:
            found = renaming(symbol, params.new_name, server.open.files(symbol))
        except CannotRenameError as fault:
            raise JsonRpcInvalidParams(str(fault)) from None
        changes: dict[str, list[lsp.TextEdit]] = {}
        for one in found:
            edit = lsp.TextEdit(_stretch(server, one), params.new_name)
            changes.setdefault(server.uri(one.analysis.path), []).append(edit)
        return lsp.WorkspaceEdit(changes)


def _stretch(server: ScenarioServer, use: Occurrence) -> lsp.Range:
    return server.range(use.analysis.draft, use.mention.start, use.mention.end)


def _add_pictures(server: ScenarioServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_CODE_LENS)
    def lenses(params: lsp.CodeLensParams) -> list[lsp.CodeLens]:
        uri = params.text_document.uri
        analysis = server.open.words(path_of(uri))
        return [] if analysis is None else [_lens(server, analysis.draft, uri, *one) for one in scenarios(analysis)]

    @server.command(PREVIEW)
    async def preview(uri: str, name: str) -> str | None:
        """Draw the plan of a scenario and show the picture; the answer is its file."""
        picture = server.picture(re.sub(r"[^\w.-]", "_", name))
        loop = asyncio.get_running_loop()
        try:
            await loop.run_in_executor(server.checker, server.open.preview, path_of(uri), name, picture)
        except CompileError as fault:
            first = str(fault).partition("\n")[0]
            server.window_show_message(lsp.ShowMessageParams(lsp.MessageType.Error, f"no preview of '{name}': {first}"))
            return None
        await server.window_show_document_async(lsp.ShowDocumentParams(server.uri(str(picture)), external=True))
        return str(picture)


def _lens(server: ScenarioServer, draft: Draft, uri: str, name: str, tag: Tag) -> lsp.CodeLens:
    where = server.range(draft, tag.start, tag.start + len(tag.name) + 1)
    return lsp.CodeLens(where, lsp.Command("Preview", PREVIEW, arguments=[uri, name]))


def path_of(uri: str) -> str:
    """Return the path of a file's URI; for a text that is not yet a file, its name."""
    return uris.to_fs_path(uri) or uri.rpartition(":")[2]
