"""The public names of a package, each imported from its module when it is first used.

A package whose `__init__.py` asks this module has a stub, `__init__.pyi`, beside it, with lines such as `from
scenario_compiler.home import Name as Name`. The stub is the only list of the names; type checkers and editors read it
too. Importing such a package imports no other module.
"""

from __future__ import annotations

import ast
import functools
import importlib
import sys
from collections.abc import Mapping
from pathlib import Path


@functools.cache
def public_names(package: str) -> Mapping[str, str]:
    """Return the public names of an imported package, and the module that each is imported from."""
    stub = Path(str(sys.modules[package].__file__)).with_suffix(".pyi")
    lines = ast.parse(stub.read_text(encoding="utf-8")).body
    return {one.name: str(line.module) for line in lines if isinstance(line, ast.ImportFrom) for one in line.names}


def public_object(package: str, name: str) -> object:
    """Return the object of a public name of a package; for `__all__`, the sorted names.

    Raises:
        AttributeError: The package has no such public name.
    """
    names = public_names(package)
    if name == "__all__":
        return sorted(names)
    if name not in names:
        raise AttributeError(f"module '{package}' has no attribute '{name}'")
    return getattr(importlib.import_module(names[name]), name)
