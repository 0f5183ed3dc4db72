"""The error of both forms when the engine's arithmetic has no result, with its place."""

from __future__ import annotations

import traceback
from pathlib import Path

KINDS = ("division by zero", "no real result", "a number too large", "an index outside its column")
"""The kinds of failures, in the order of engine.h's FAIL_... numbers from 1 on."""


class EngineError(Exception):
    """The engine stopped because its arithmetic had no result.

    Attributes:
        kind: One of KINDS.
        file: Name of the marked function's file, without folders.
        line: Line in that file.
    """

    def __init__(self, kind: str, file: str, line: int) -> None:
        """Set what failed and where."""
        super().__init__(f"the engine broke off at {file}:{line}: {kind}")
        self.kind, self.file, self.line = kind, file, line


def of_exception(error: ArithmeticError | ValueError | IndexError) -> EngineError:
    """Return the error for an exception from a marked function, with the compiled form's kind."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    if isinstance(error, ZeroDivisionError):
        kind = KINDS[0]
    elif isinstance(error, IndexError):
        kind = KINDS[3]
    else:
        kind = KINDS[1] if isinstance(error, ValueError) and "NaN" not in str(error) else KINDS[2]
    return EngineError(kind, Path(place.filename).name, place.lineno or 0)
