"""The code that pages show."""

from __future__ import annotations

import re


def code_blocks(page: str, language: str) -> list[str]:
    """Return the blocks of code of a language in a page's Markdown, in their order."""
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)
