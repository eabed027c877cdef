"""Copies the prose of files into a folder, line for line: Markdown, and comments of Rust and Python on lines of their own.

Code inside the prose becomes a placeholder.

    prose.py FOLDER FILE..
"""

import itertools
import re
import sys
from pathlib import Path

#: Code within a line, formulas, addresses and numbers.
INLINE = re.compile(r"`[^`]*`|\$[^$]+\$|<[^<>]*>|https?://\S+|\d+")

#: A comment on a line of its own.
COMMENT = {".rs": re.compile(r"^\s*//[/!]?( .*)?$"), ".py": re.compile(r"^\s*#[: ](.*)$")}

FENCE = re.compile(r"^\s*(```|~~~)")


def prose(lines: list[str], ending: str) -> list[str]:
    """The prose of each line. A line without prose becomes a full stop, so that no word around it seems to be repeated."""
    codes = itertools.count()
    found, inside = [], False
    for line in lines:
        text = line
        if ending in COMMENT:
            comment = COMMENT[ending].match(line)
            text = (comment.group(1) or "").strip() if comment else ""
        if FENCE.match(text):
            inside = not inside
            text = ""
        elif inside or text.startswith("    "):
            text = ""
        found.append(INLINE.sub(lambda _: f"Item{next(codes)}", text) or ".")
    return found


def main() -> None:
    folder, files = Path(sys.argv[1]), sys.argv[2:]
    for name in files:
        path = Path(name)
        to = folder / name
        to = to.with_name(f"{to.name}.md")
        to.parent.mkdir(parents=True, exist_ok=True)
        lines = path.read_text(encoding="utf-8").splitlines()
        to.write_text("\n".join(prose(lines, path.suffix)) + "\n", encoding="utf-8")


main()
