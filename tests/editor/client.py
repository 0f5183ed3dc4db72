"""A client of the real server, which runs in a process of its own and is connected by stdin and stdout."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

WAIT = 60.0
"""Time after which an answer is no longer waited for, s."""


class Client(LanguageClient):
    """A client that keeps what the server tells it."""

    def __init__(self) -> None:
        """Know nothing yet."""
        super().__init__("test", "1")
        self.published: dict[str, list[lsp.Diagnostic]] = {}
        self.shown: list[str] = []
        self.messages: list[str] = []
        self.news = asyncio.Event()
        self.written: list[lsp.TextDocumentIdentifier] = []

        @self.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)  # type: ignore[untyped-decorator]  # pygls has no types there
        def keep(params: lsp.PublishDiagnosticsParams) -> None:
            self.published[params.uri] = list(params.diagnostics)
            self.news.set()

        @self.feature(lsp.WINDOW_SHOW_DOCUMENT)  # type: ignore[untyped-decorator]  # pygls has no types there
        def show(params: lsp.ShowDocumentParams) -> lsp.ShowDocumentResult:
            self.shown.append(params.uri)
            return lsp.ShowDocumentResult(success=True)

        @self.feature(lsp.WINDOW_SHOW_MESSAGE)  # type: ignore[untyped-decorator]  # pygls has no types there
        def read_message(params: lsp.ShowMessageParams) -> None:
            self.messages.append(params.message)

    def write(self, path: Path, text: str) -> lsp.TextDocumentIdentifier:
        """Open a text as that of a file."""
        document = lsp.TextDocumentItem(path.as_uri(), "xml", 1, text)
        self.text_document_did_open(lsp.DidOpenTextDocumentParams(document))
        self.written.append(lsp.TextDocumentIdentifier(path.as_uri()))
        return self.written[-1]

    def change(self, path: Path, version: int, text: str) -> None:
        """Put another text in an open one's place."""
        document = lsp.VersionedTextDocumentIdentifier(version, path.as_uri())
        whole = lsp.TextDocumentContentChangeWholeDocument(text)
        self.text_document_did_change(lsp.DidChangeTextDocumentParams(document, [whole]))

    @contextmanager
    def opened(self, folder: Path) -> Iterator[None]:
        """Have a folder open; texts opened meanwhile are closed with it, and the answers are forgotten."""
        here = [lsp.WorkspaceFolder(folder.as_uri(), folder.name)]
        self._changed_folders(lsp.WorkspaceFoldersChangeEvent(added=here, removed=[]))
        try:
            yield
        finally:
            for document in self.written:
                self.text_document_did_close(lsp.DidCloseTextDocumentParams(document))
            self._changed_folders(lsp.WorkspaceFoldersChangeEvent(added=[], removed=here))
            for told in (self.written, self.published, self.shown, self.messages):
                told.clear()

    def _changed_folders(self, event: lsp.WorkspaceFoldersChangeEvent) -> None:
        self.workspace_did_change_workspace_folders(lsp.DidChangeWorkspaceFoldersParams(event))

    async def found(self, path: Path, wanted: Callable[[list[lsp.Diagnostic]], bool]) -> list[lsp.Diagnostic]:
        """Wait until what is wrong with a text is as wanted, and return it."""

        async def wait() -> list[lsp.Diagnostic]:
            while path.as_uri() not in self.published or not wanted(self.published[path.as_uri()]):
                self.news.clear()
                await self.news.wait()
            return self.published[path.as_uri()]

        return await asyncio.wait_for(wait(), WAIT)


@asynccontextmanager
async def served(folder: Path, *, encodings: list[str] | None = None, snippets: bool = True) -> AsyncIterator[Client]:
    """Start the real server for a folder; stop it at the end."""
    client = Client()
    await client.start_io(sys.executable, "-m", "scenario_compiler", "lsp", "--stdio")
    item: Any = lsp.ClientCompletionItemOptions(snippet_support=snippets)
    text = lsp.TextDocumentClientCapabilities(completion=lsp.CompletionClientCapabilities(completion_item=item))
    general = lsp.GeneralClientCapabilities(position_encodings=encodings)
    capabilities = lsp.ClientCapabilities(text_document=text, general=general)
    folders = [lsp.WorkspaceFolder(folder.as_uri(), folder.name)]
    params = lsp.InitializeParams(capabilities=capabilities, workspace_folders=folders, process_id=None)
    await client.initialize_async(params)
    client.initialized(lsp.InitializedParams())
    try:
        yield client
    finally:
        await client.shutdown_async(None)
        client.exit(None)
        await client.stop()  # type: ignore[no-untyped-call]  # pygls has no types there
