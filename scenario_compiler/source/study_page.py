"""Pages of instruction and consent: Markdown files beside a study, with their pictures.

Pictures are embedded in the page, so that a study's server does not serve files that a page names.
"""

from __future__ import annotations

import base64
import re
from html import escape
from pathlib import Path
from urllib.parse import unquote, urlsplit

from markdown_it import MarkdownIt
from markdown_it.token import Token

from scenario_compiler.diagnostics import Diagnostics, FilePlace, Place
from scenario_compiler.files import read_file
from scenario_compiler.source.study import UNREADABLE_PART

TYPES = {
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
    ".gif": "image/gif",
    ".webp": "image/webp",
    ".svg": "image/svg+xml",
}
"""Media types of pictures by their file suffixes."""

COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)

LARGEST = 8 * 1024 * 1024
"""Greatest size of a picture, bytes."""


def read_page(name: str, folder: Path, place: Place, sink: Diagnostics) -> str | None:
    """Return a page as HTML, with any HTML in the file as plain text, but no comments; None if it cannot be read.

    Args:
        name: The Markdown file, as the study names it.
        folder: Folder of the study.
        place: Where the study names it.
        sink: Receives the faults of the file and its pictures.
    """
    path = folder / name
    try:
        text = read_file(path).decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        sink.add(UNREADABLE_PART, f"'{name}' is not UTF-8: byte {fault.start}", place)
        return None
    except (OSError, ValueError) as fault:
        sink.add(UNREADABLE_PART, f"'{name}' cannot be read: {_reason(fault)}", place)
        return None
    if not text.strip():
        sink.add(UNREADABLE_PART, f"'{name}' is empty", place)
        return None
    markdown = MarkdownIt("commonmark").enable("table")
    tokens = markdown.parse(text)
    for block in tokens:
        _show_html(block)
        for token in block.children or ():
            _show_html(token)
            if token.type == "image":
                line = 0 if block.map is None else block.map[0] + 1
                _take_in(token, path.parent, FilePlace(str(path), line), sink)
    return str(markdown.renderer.render(tokens, markdown.options, {}))


def _show_html(token: Token) -> None:
    """Let HTML be shown as the text that it is; a comment is for the authors of the page."""
    if token.type not in ("html_block", "html_inline"):
        return
    shown = escape(COMMENT.sub("", token.content))
    if token.type == "html_block":
        shown = f"<p>{shown.strip()}</p>\n" if shown.strip() else ""
    token.content = shown


def _take_in(image: Token, folder: Path, place: Place, sink: Diagnostics) -> None:
    """Replace the address of a picture by the contents of its file."""
    address = str(image.attrs["src"])
    if urlsplit(address).scheme or address.startswith("//"):
        sink.add(
            UNREADABLE_PART, f"'{address}' is not a file beside the page; pages are shown without a network", place
        )
        return
    name = unquote(address)
    kind = TYPES.get(Path(name).suffix.lower())
    if kind is None:
        sink.add(UNREADABLE_PART, f"'{name}' is not a picture in one of the formats {', '.join(TYPES)}", place)
        return
    try:
        content = read_file(folder / name, LARGEST)
    except (OSError, ValueError) as fault:
        sink.add(UNREADABLE_PART, f"the picture '{name}' cannot be read: {_reason(fault)}", place)
        return
    image.attrs["src"] = f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _reason(fault: OSError | ValueError) -> str:
    return fault.strerror if isinstance(fault, OSError) and fault.strerror else str(fault)
