"""`@compiled` marks a function that runs both interpreted and compiled (ARCHITECTURE.md, "One engine, two forms").

The decorator only registers: a marked function stays a plain Python function. `forms.translation` writes all
registered functions into one file of C.
"""

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

REGISTRY: list[Callable[..., Any]] = []


def compiled(function: Function) -> Function:
    """Register `function` for the compiled engine and return it unchanged."""
    REGISTRY.append(function)
    return function
