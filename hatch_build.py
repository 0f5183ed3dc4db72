"""The build hook: the engine's machine code is made with the package and lies in the wheel.

Where there is no gcc or clang, the compiler comes from PyPI as `ziglang`, for the build alone. Without any compiler the
package is built nevertheless: the interpreted form of the engine serves then, and reports it.
"""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT))

from scenario_compiler.forms.making import BuildError, NoCompilerError, compiler, make  # noqa: E402
from scenario_compiler.forms.note import LIBRARY, NOTE  # noqa: E402

COMPILER = "ziglang>=0.13"
"""A C compiler as a Python package, 411 MB: needed only while a wheel is built where there is no other."""


SWEEPS = "scenario_compiler.batch.typical_sweeps"
"""The sweeps that guide gcc; they need what the program needs, which a build in isolation does not have."""


class EngineBuildHook(BuildHookInterface):  # type: ignore[type-arg]
    """Makes the engine's machine code for a wheel, or in place for an editable installation."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what the build needs beside hatchling."""
        try:
            compiler()
        except NoCompilerError:
            return [COMPILER]
        return []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the library and put it into the wheel, which is then for this platform and for every Python 3."""
        try:
            note = make(noting_sources=version == "editable", sweeps=SWEEPS)
        except NoCompilerError as error:
            self.app.display_warning(f"the engine will run interpreted: {error}")
            return
        except BuildError as error:
            self.app.abort(f"the engine cannot be built: {error}")
        self.app.display_info(f"the engine is built as C by {note.made_by}")
        if version == "editable":
            return
        for path in (LIBRARY, NOTE):
            build_data["force_include"][str(path)] = path.relative_to(ROOT).as_posix()
        build_data["pure_python"] = False
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
