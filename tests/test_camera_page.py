"""The page on the camera: its code runs, prints the shown output, and passes mypy; its pictures can be made again."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import cv2
import pytest

from tests.pages import code_blocks

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "docs" / "camera.md").read_text(encoding="utf-8")
PROGRAM = "\n".join(code_blocks(PAGE, "python"))


def test_code_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(PROGRAM, "docs/camera.md", "exec"), {"__name__": "page"})
    printed = capsys.readouterr().out.strip()
    assert f"It prints `{printed}`" in PAGE


@pytest.mark.slow
def test_code_of_the_page_has_types(tmp_path: Path) -> None:
    """Run by `make check`, where mypy has just read the package."""
    file = tmp_path / "page.py"
    file.write_text(PROGRAM, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", str(file)]
    checked = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert checked.stdout + checked.stderr == ""


def test_pictures_of_the_page_are_made_by_the_example(tmp_path: Path) -> None:
    """As large as those of the page, and the same but for single pixels, which differ between processors."""
    folder = tmp_path / "new" / "pictures"
    subprocess.run([sys.executable, str(ROOT / "examples" / "camera.py"), str(folder)], check=True)
    for made in sorted(folder.iterdir()):
        fresh, shown = (cv2.imread(str(path)) for path in (made, ROOT / "docs" / "images" / made.name))
        assert fresh is not None
        assert shown is not None
        assert fresh.shape == shown.shape
        assert float(cv2.absdiff(fresh, shown).mean()) < 1.0, f"{made.name} is stale: examples/camera.py makes it"
    assert len(list(folder.iterdir())) == 3
