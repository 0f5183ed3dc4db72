"""The open texts of an editor with their findings, and the files in its folders."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import CompileError, Diagnostics
from scenario_compiler.editor.analysis import Analysis, Symbol, read_analysis
from scenario_compiler.editor.findings import Finding, carried_over, findings, while_written
from scenario_compiler.editor.words import ROOTS, is_scenario_file
from scenario_compiler.files import suffix_of, unsaved
from scenario_compiler.resources import library_folder, template_folders
from scenario_compiler.source.catalogs import catalogs_in
from scenario_compiler.source.templates import templates_in

MOST_FILES = 5000
"""Most files of a workspace that are looked through for a name."""

PASSED_OVER = {"node_modules", "build", "dist", "__pycache__"}
"""Folders of a workspace that are not looked into, besides those whose names begin with a point."""


@dataclass
class Workspace:
    """The texts that an editor holds, by their files' real paths, and the folders that it has open.

    Attributes:
        folders: The folders.
        maps: Folders in which maps are looked for first.
        texts: The texts.
        found: What was last found of each text, and the text that it was found of.
    """

    folders: list[Path] = field(default_factory=list)
    maps: Sequence[Path] = ()
    texts: dict[str, Analysis] = field(default_factory=dict)
    found: dict[str, tuple[str, list[Finding]]] = field(default_factory=dict)

    def hold(self, path: str, text: str) -> None:
        """Take in a text that was opened or changed."""
        self.texts[os.path.realpath(path)] = Analysis(path, text)
        self._read_again(path)

    def let_go(self, path: str) -> None:
        """Forget a text that was closed."""
        self.texts.pop(os.path.realpath(path), None)
        self.found.pop(os.path.realpath(path), None)
        self._read_again(path)

    def saved(self, path: str) -> None:
        """Look at all texts again: a file that they may name was saved."""
        self._read_again(path)
        for name, analysis in list(self.texts.items()):
            self.texts[name] = Analysis(analysis.path, analysis.draft.text)

    def _read_again(self, path: str) -> None:
        """Let templates and catalogs be read again where a file of theirs has changed: they are kept for long."""
        real = Path(os.path.realpath(path))
        if any(real.is_relative_to(folder.resolve()) for folder in (library_folder(), *template_folders())):
            templates_in.cache_clear()
            catalogs_in.cache_clear()

    def analysis(self, path: str) -> Analysis | None:
        """Return the text of a file that is open."""
        return self.texts.get(os.path.realpath(path))

    def words(self, path: str) -> Analysis | None:
        """Return the text of an open file that is written word by word: one of our own languages, or an empty one."""
        analysis = self.analysis(path)
        if analysis is None or suffix_of(path) not in (".xml", ""):
            return None
        root = analysis.draft.root
        return analysis if root is None or root.name in ROOTS or not analysis.draft.text.strip() else None

    def check(self, path: str) -> list[Finding]:
        """Return the findings of an open text, and store them; an unfinished part keeps its earlier findings."""
        own = os.path.realpath(path)
        analysis = self.texts.get(own)
        if analysis is None:
            return []
        if suffix_of(path) not in (".xosc", ".xodr") and not is_scenario_file(analysis.draft):
            return []
        text = analysis.draft.text
        old, before = self.found.get(own, ("", []))
        found = findings(analysis.path, analysis.draft, self._held(), self.maps)
        shown = while_written(found, carried_over(before, old, text))
        self.found[own] = (text, shown)
        return shown

    def preview(self, path: str, name: str, picture: Path) -> None:
        """Draw the plan of a scenario of an open text.

        Raises:
            CompileError: The scenario is at fault.
        """
        from scenario_compiler.report.preview import draw_preview

        sink = Diagnostics()
        with unsaved(self._held()):
            compilation = compile_target(f"{path}#{name}", {}, sink, maps=self.maps)
        if compilation is None:
            raise CompileError(sink)
        draw_preview(compilation.plan, compilation.network, picture)

    def files(self, symbol: Symbol | None = None) -> Iterator[Analysis]:
        """Yield the open texts and the other XML files of the workspace; with a symbol, those that have its name.

        The file that a symbol is declared in is among them only where it is open or in the workspace.
        """
        yield from self.texts.values()
        for path in self._paths():
            if os.path.realpath(path) not in self.texts:
                analysis = read_analysis(path) if symbol is None or _holds(path, symbol.name) else None
                if analysis is not None:
                    yield analysis

    def _paths(self) -> Iterator[Path]:
        left = MOST_FILES
        for top in self.folders:
            for folder, inner, names in os.walk(top):
                inner[:] = sorted(one for one in inner if not one.startswith(".") and one not in PASSED_OVER)
                for name in sorted(names):
                    if suffix_of(name) == ".xml" and (left := left - 1) >= 0:
                        yield Path(folder, name)

    def _held(self) -> dict[str, bytes]:
        return {path: one.draft.content for path, one in list(self.texts.items())}


def _holds(path: Path, name: str) -> bool:
    """Return whether a file has a name in it."""
    try:
        return name.encode() in path.read_bytes()
    except OSError:
        return False
