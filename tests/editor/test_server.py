"""The server as an editor sees it: a process of its own that speaks the protocol."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from scenario_compiler.editor.workspace import Workspace
from scenario_compiler.resources import library_folder, templates_from
from tests.editor.client import Client, served

TEXT = """<scenarios version="1">
  <template name="parked" summary="A parked van">
    <parameter name="far" type="length" default="80" min="20" max="300"/>
    <static id="van"><at><ahead_of entity="ego" distance="$far"/></at></static>
  </template>
  <scenario name="ours" map="town_grid" duration="30">
    <ego speed="12"><start><spawn_point name="main_street"/></start></ego>
    <use template="parked" far="60"/>
    <takeover budget="7"><cause kind="path_blocked"/></takeover>
  </scenario>
</scenarios>
"""


Talk = Callable[[Client], Awaitable[None]]
Session = Callable[[Path, Talk], None]


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    """A function that talks to a server that has a folder open; it is one server for all tests."""
    loop = asyncio.new_event_loop()
    serving = served(tmp_path_factory.mktemp("none"))
    with ThreadPoolExecutor(1) as thread:  # a browser's tests leave an event loop running in this one
        client = thread.submit(loop.run_until_complete, serving.__aenter__()).result()

        async def conversation(folder: Path, talk: Talk) -> None:
            with client.opened(folder):
                await talk(client)

        def talk_in(folder: Path, talk: Talk) -> None:
            thread.submit(loop.run_until_complete, conversation(folder, talk)).result()

        yield talk_in
        thread.submit(loop.run_until_complete, serving.__aexit__(None, None, None)).result()
        loop.close()


def session_of_its_own(folder: Path, talk: Talk, **options: Any) -> None:
    """Talk to a server that is started for it with options, and has a folder open."""

    async def run() -> None:
        async with served(folder, **options) as client:
            await talk(client)

    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, run()).result()


def place_of(text: str, marked: str, units: Callable[[str], int] = len) -> lsp.Position:
    """Return the position behind the first occurrence of something in a text."""
    before = text[: text.index(marked) + len(marked)]
    return lsp.Position(before.count("\n"), units(before.rpartition("\n")[2]))


def at(path: Path, position: lsp.Position) -> dict[str, Any]:
    """Return what a request says of a place in a text."""
    return {"text_document": lsp.TextDocumentIdentifier(path.as_uri()), "position": position}


def test_findings_come_while_the_text_is_written(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "ours.xml"

    async def talk(client: Client) -> None:
        client.write(path, TEXT)
        assert await client.found(path, lambda found: True) == []
        client.change(path, 2, TEXT.replace('template="parked"', 'template="parkt"'))
        (unknown,) = await client.found(path, bool)
        assert unknown.code == "SC213"
        assert (unknown.range.start, unknown.range.end) == (lsp.Position(7, 19), lsp.Position(7, 24))
        assert "did you mean 'parked'?" in unknown.message
        client.change(path, 3, TEXT.replace('template="parked"', 'template="parkt"').replace("</scenarios>", "<"))
        kept = await client.found(path, lambda found: any(one.code == "SC102" for one in found))
        assert {str(one.code) for one in kept} == {"SC102", "SC213"}
        client.change(path, 4, TEXT)
        assert await client.found(path, lambda found: not found) == []

    session(tmp_path, talk)


def test_completion_with_and_without_places_to_fill_in(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "ours.xml"
    text = TEXT.replace("    <takeover", "    <sto\n    <takeover")
    inserted = []

    async def talk(client: Client) -> None:
        client.write(path, text)
        answer = await client.text_document_completion_async(lsp.CompletionParams(**at(path, place_of(text, "<sto"))))
        assert isinstance(answer, lsp.CompletionList)
        static = next(one for one in answer.items if one.label == "static")
        assert isinstance(static.text_edit, lsp.TextEdit)
        assert static.text_edit.range == lsp.Range(lsp.Position(8, 5), lsp.Position(8, 8))
        inserted.append(static.text_edit.new_text)

    session(tmp_path, talk)
    session_of_its_own(tmp_path, talk, snippets=False)
    assert inserted == ['static id="$1"><at>$2</at></static>', 'static id=""><at></at></static>']


def test_names_across_the_files_of_a_folder(session: Session, tmp_path: Path) -> None:
    templates, path = tmp_path / "templates.xml", tmp_path / "ours.xml"
    head, _, rest = TEXT.partition("  <scenario ")
    templates.write_text(f"{head}</scenarios>\n", encoding="utf-8")
    using = f'<scenarios version="1">\n  <include file="templates.xml"/>\n  <scenario {rest}'
    path.write_text(using, encoding="utf-8")

    async def talk(client: Client) -> None:
        client.write(path, using)
        far = lsp.TextDocumentPositionParams(**at(path, place_of(using, " far")))
        there = await client.text_document_definition_async(lsp.DefinitionParams(far.text_document, far.position))
        assert isinstance(there, lsp.Location)
        assert there.uri == templates.as_uri()
        assert there.range.start == lsp.Position(2, 21)
        context = lsp.ReferenceContext(include_declaration=True)
        params = lsp.ReferenceParams(context, far.text_document, far.position)
        places = await client.text_document_references_async(params)
        assert sorted((Path(one.uri).name, one.range.start.line) for one in places or ()) == [
            ("ours.xml", 4), ("templates.xml", 2), ("templates.xml", 3),
        ]  # fmt: skip
        edit = await client.text_document_rename_async(lsp.RenameParams(far.text_document, far.position, "away"))
        assert edit is not None
        assert {Path(uri).name: len(edits) for uri, edits in (edit.changes or {}).items()} == {
            "ours.xml": 1,
            "templates.xml": 2,
        }
        with pytest.raises(JsonRpcException, match="cannot be the new name"):
            await client.text_document_rename_async(lsp.RenameParams(far.text_document, far.position, "7"))
        client.change(path, 2, using.replace("parked", "blocked_lane"))
        shipped = at(path, place_of(using, 'template="par'))
        with pytest.raises(JsonRpcException, match=r"blocked_lane\.xml, which is not among the files open here"):
            await client.text_document_rename_async(lsp.RenameParams(**shipped, new_name="other"))

    session(tmp_path, talk)


def test_an_included_file_is_read_as_it_is_in_the_editor(session: Session, tmp_path: Path) -> None:
    templates, path = tmp_path / "templates.xml", tmp_path / "ours.xml"
    head, _, rest = TEXT.partition("  <scenario ")
    templates.write_text('<scenarios version="1"/>\n', encoding="utf-8")
    using = f'<scenarios version="1">\n  <include file="templates.xml"/>\n  <scenario {rest}'

    async def talk(client: Client) -> None:
        client.write(path, using)
        assert [one.code for one in await client.found(path, bool)] == ["SC213"]
        client.write(templates, f"{head}</scenarios>\n")
        client.change(path, 2, using + "\n")
        assert await client.found(path, lambda found: not found) == []

    session(tmp_path, talk)


@pytest.mark.parametrize(
    ("encoding", "size"), [("utf-16", 2), pytest.param("utf-32", 4, marks=pytest.mark.slow), ("utf-8", 1)]
)
def test_positions_are_counted_in_the_negotiated_encoding(tmp_path: Path, encoding: str, size: int) -> None:
    path = tmp_path / "ours.xml"
    text = TEXT.replace('summary="A parked van"', 'summary="\U0001f697 ü" source="$nowhere"').replace(
        '<use template="parked"', '<!-- \U0001f697ü --><use template="parkt"'
    )

    def units(one: str) -> int:
        return len(one.encode(f"{encoding}-le" if size > 1 else encoding)) // size

    async def talk(client: Client) -> None:
        client.write(path, text)
        found = await client.found(path, bool)
        unknown = next(one for one in found if one.code == "SC213")
        assert unknown.range.start == place_of(text, 'use template="', units)
        hover = await client.text_document_hover_async(lsp.HoverParams(**at(path, place_of(text, "ü --><u", units))))
        assert hover is not None
        assert hover.range is not None
        assert hover.range.start == place_of(text, "ü --><", units)

    session_of_its_own(tmp_path, talk, encodings=[encoding])


def test_the_lens_over_a_scenario_draws_its_plan(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "ours.xml"

    async def talk(client: Client) -> None:
        document = client.write(path, TEXT)
        lenses = await client.text_document_code_lens_async(lsp.CodeLensParams(document))
        assert lenses is not None
        (lens,) = lenses
        assert lens.command is not None
        assert (lens.range.start.line, lens.command.title) == (5, "Preview")
        command = lsp.ExecuteCommandParams(lens.command.command, lens.command.arguments)
        picture = await client.workspace_execute_command_async(command)
        assert Path(str(picture)).read_bytes().startswith(b"\x89PNG")
        assert client.shown == [Path(str(picture)).as_uri()]
        client.change(path, 2, TEXT.replace("main_street", "nowhere"))
        assert await client.workspace_execute_command_async(command) is None
        assert "SC376" in client.messages[0]

    session(tmp_path, talk)


def test_symbols_layout_and_highlights(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "ours.xml"
    text = TEXT.replace("    <static", "  <static")

    async def talk(client: Client) -> None:
        document = client.write(path, text)
        symbols = await client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
        assert [one.name for one in symbols or ()] == ["parked", "ours"]
        options = lsp.FormattingOptions(tab_size=4, insert_spaces=True)
        edits = await client.text_document_formatting_async(lsp.DocumentFormattingParams(document, options))
        assert [(one.range.start, one.range.end, one.new_text) for one in edits or ()] == [
            (lsp.Position(3, 0), lsp.Position(3, 2), "    ")
        ]
        marked = lsp.DocumentHighlightParams(**at(path, place_of(text, "$fa")))
        highlights = await client.text_document_document_highlight_async(marked)
        assert [one.range.start.line for one in highlights or ()] == [2, 3, 7]

    session(tmp_path, talk)


def test_other_languages_get_findings_only(session: Session, tmp_path: Path, repository: Path) -> None:
    scenario = (repository / "tests" / "benchmarks" / "scripted.xosc").read_text(encoding="utf-8")
    road = (repository / "tests" / "benchmarks" / "bends.xodr").read_text(encoding="utf-8")
    ours, roads = tmp_path / "one.xosc", tmp_path / "bends.xodr"

    async def talk(client: Client) -> None:
        client.write(roads, road.replace("<road ", "<raod ", 1).replace("</road>", "</raod>", 1))
        assert {one.severity for one in await client.found(roads, bool)} == {lsp.DiagnosticSeverity.Error}
        document = client.write(ours, scenario.replace("<Story ", "<Stori ", 1).replace("</Story>", "</Stori>", 1))
        assert any("Stori" in one.message for one in await client.found(ours, bool))
        assert await client.text_document_hover_async(lsp.HoverParams(document, lsp.Position(3, 5))) is None
        offered = await client.text_document_completion_async(lsp.CompletionParams(document, lsp.Position(3, 5)))
        assert isinstance(offered, lsp.CompletionList)
        assert list(offered.items) == []

    session(tmp_path, talk)


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("<project><modelVersion>4</modelVersion></project>", []),
        ("<project><modelVersion></project>", []),
        ("<config><name>ours</name></config>", []),
        ("", []),
        ('<scenarois version="1"/>', ["SC116"]),
        ('<config><scenarios><scenario name="x"/></scenarios></config>', ["SC214", "SC240"]),
        ("<OpenSCENARIO/>", ["SC108"]),
    ],
)
def test_other_xml_files_get_no_findings(tmp_path: Path, text: str, codes: list[str]) -> None:
    workspace = Workspace()
    workspace.hold(str(tmp_path / "any.xml"), text)
    assert sorted({one.code for one in workspace.check(str(tmp_path / "any.xml"))}) == codes


@pytest.mark.parametrize("encoding", ["UTF-8", "UTF-16", "ISO-8859-1"])
def test_the_declared_encoding_is_that_of_the_file_not_of_the_text(tmp_path: Path, encoding: str) -> None:
    text = (
        f'<?xml version="1.0" encoding="{encoding}"?><scenarios version="1"><scenario name="ä" map="town_grid" '
        'duration="1"><ego sped="1"><start><spawn_point name="main_street"/></start></ego></scenario></scenarios>'
    )
    workspace = Workspace()
    workspace.hold(str(tmp_path / "it.xml"), text)
    (found,) = workspace.check(str(tmp_path / "it.xml"))
    assert (found.code, text[found.start : found.end]) == ("SC106", "sped")


def test_every_file_of_the_library_is_without_findings(session: Session, tmp_path: Path) -> None:
    async def talk(client: Client) -> None:
        for path in sorted(library_folder().glob("*/*.xml"))[:6]:
            client.write(path, path.read_text(encoding="utf-8"))
            assert await client.found(path, lambda found: True) == []

    session(tmp_path, talk)


@pytest.mark.slow
def test_a_template_of_a_folder_is_read_as_it_is_in_the_editor(tmp_path: Path) -> None:
    ours, path = tmp_path / "ours" / "ours.xml", tmp_path / "conflict.xml"
    ours.parent.mkdir()
    text = TEXT.partition("  <scenario ")[0] + "</scenarios>\n"
    ours.write_text(text, encoding="utf-8")
    using = TEXT[: TEXT.index("  <template")] + TEXT[TEXT.index("  <scenario ") :]
    with templates_from([ours.parent]):
        workspace = Workspace()
        workspace.hold(str(path), using)
        assert workspace.check(str(path)) == []
        workspace.hold(str(ours), text.replace("far", "farther"))
        assert [one.code for one in workspace.check(str(path))] == ["SC106"]
        workspace.let_go(str(ours))
        assert workspace.check(str(path)) == []
