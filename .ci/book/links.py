"""Checks a built book: every reference leads to a file or an anchor of the book, and every picture has an alternative text.

The book must be readable without a network: references to other hosts are refused, except links that a reader may follow.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Anchors of a page, its references `(line, attribute, target)`, and its pictures without a text."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.references, self.mistakes = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        line = self.getpos()[0]
        if values.get("id"):
            self.anchors.add(values["id"])
        for name in ("href", "src"):
            if values.get(name) is not None:
                self.references.append((line, f"{tag} {name}", values[name]))
        if tag == "img" and not values.get("alt"):
            self.mistakes.append((line, f"picture without alt text: {values.get('src')}"))


def mistakes(root):
    """Every mistake of the book, as `page:line: mistake`."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(root.rglob("*.html"))}
    for path, page in pages.items():
        name = path.relative_to(root)
        for line, what in page.mistakes:
            yield f"{name}:{line}: {what}"
        for line, kind, target in page.references:
            what = mistake(root, path, pages, kind, target)
            if what:
                yield f"{name}:{line}: {kind} `{target}`: {what}"


def mistake(root, path, pages, kind, target):
    """The mistake in one reference; `None` if it is right."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return None if kind == "a href" or parts.scheme == "data" else "needs a network"
    # The links of mdBook's page for unknown addresses are relative to the root of the site.
    if path.name == "404.html":
        return None
    file = (path.parent / unquote(parts.path)).resolve() if parts.path else path.resolve()
    if root.resolve() not in file.parents and file != root.resolve():
        return "leads out of the book"
    if not file.exists():
        return "no such file"
    page = pages.get(root / file.relative_to(root.resolve()))
    if parts.fragment and page and unquote(parts.fragment) not in page.anchors:
        return "no such anchor"
    return None


def main():
    root = Path(sys.argv[1])
    found = list(mistakes(root))
    for text in found:
        print(text)
    count = len(list(root.rglob("*.html")))
    print(f"{count} pages, {len(found)} mistakes")
    return 1 if found or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
