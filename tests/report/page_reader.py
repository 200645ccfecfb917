"""Reads a page as a browser does, and finds fault with it."""

import re
from html.parser import HTMLParser

EMPTY = {"meta", "link", "img", "br", "hr", "input", "wbr"}
"""Elements without an end."""


class Reader(HTMLParser):
    """Reads a page, and finds fault with it."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text += data


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert reader.open == []
    reader.text = " ".join(reader.text.split())
    return reader


def ensure_self_contained(page: str, reader: Reader) -> None:
    """A document that needs no other file and runs nothing, whose links lead somewhere, without a word of Python."""
    assert page.startswith("<!DOCTYPE html>")
    addresses = [attrs[key] for _, attrs in reader.tags for key in ("src", "href") if key in attrs]
    assert all(address and address.startswith(("data:", "#")) for address in addresses)
    assert not {"script", "iframe", "object", "base"} & {tag for tag, _ in reader.tags}
    assert not re.search(r"url\((?!%23)", page)  # but to a part of the same picture
    assert "@import" not in page
    names = [attrs["id"] for _, attrs in reader.tags if "id" in attrs]
    assert len(names) == len({*names})
    assert {address[1:] for address in addresses if address and address.startswith("#")} <= {*names}
    assert not re.search(r"\b(None|nan|inf|Undefined|True|False)\b", reader.text)
