"""The machine code in the cache: made once for its sources and versions, loaded without numba, never half of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler.engine.build import code_file, compile_engine, keep_code, kept_code

LOAD = """
import sys
from scenario_compiler.engine.build import compile_engine
compile_engine(lambda text: print(text))
print(*sorted({"numba", "numpy"} & set(sys.modules)))
"""


def test_what_is_in_the_cache_is_loaded_without_numba() -> None:
    compile_engine()
    done = subprocess.run([sys.executable, "-c", LOAD], capture_output=True, text=True, check=True)
    assert done.stdout == "\n"


@pytest.mark.parametrize("name", ["NUMBA_OPT", "NUMBA_CPU_NAME", "NUMBA_BOUNDSCHECK"])
def test_another_setting_of_the_compiler_has_a_file_of_its_own(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = code_file()
    assert code_file() == usual
    monkeypatch.setenv(name, "1")
    assert code_file() != usual


def test_half_a_file_is_none(tmp_path: Path) -> None:
    compile_engine()
    whole = code_file().read_bytes()
    file = tmp_path / "engine.code"
    for content in (b"", whole[:10], whole[:-1], whole[:-1] + bytes([whole[-1] ^ 1])):
        file.write_bytes(content)
        assert kept_code(file) is None
    assert kept_code(tmp_path / "not there") is None
    file.write_bytes(whole)
    assert kept_code(file) == whole[32:]


def test_a_cache_that_cannot_be_written_costs_the_next_compilation_alone(tmp_path: Path) -> None:
    compile_engine()
    code = code_file().read_bytes()[32:]
    (tmp_path / "engine").write_text("a file where the folder was to be")
    with pytest.raises(OSError, match="engine"):
        keep_code(tmp_path / "engine" / "key.code", code)
    (tmp_path / "key.code").mkdir()
    with pytest.raises(IsADirectoryError):
        keep_code(tmp_path / "key.code", code)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["engine", "key.code"]
    assert kept_code(tmp_path / "engine" / "key.code") is kept_code(tmp_path / "key.code") is None
