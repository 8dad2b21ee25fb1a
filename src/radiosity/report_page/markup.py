"""HTML that is escaped by construction: text of strangers, such as names of surfaces, never becomes markup."""

import base64
import html
import re

SHORT = 12  # rows; such tables are not broken over two pages
VOID = ("img", "meta", "br")
UNSHOWN = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff\u202a-\u202e\u2066-\u2069]")
TURNING = "\ufffd"  # in place of characters that HTML cannot hold, or that turn the direction of writing


class Markup(str):
    """A text that is HTML already."""


def text(value) -> Markup:
    """Return a value as HTML: markup as it is, any other text escaped."""
    return value if isinstance(value, Markup) else Markup(html.escape(UNSHOWN.sub(TURNING, str(value))))


def element(tag: str, *children, **attributes) -> Markup:
    """Return an element; ``class_`` is the attribute class, and attributes that are None are left out."""
    given = {name.rstrip("_").replace("_", "-"): value for name, value in attributes.items() if value is not None}
    head = "".join(f' {name}="{text(value)}"' for name, value in given.items())
    if tag in VOID:
        return Markup(f"<{tag}{head}>")
    return Markup(f"<{tag}{head}>{joined(children)}</{tag}>")


def joined(children) -> Markup:
    """Return children one after the other; None stands for nothing."""
    return Markup("".join(text(child) for child in children if child is not None))


def png_image(data: bytes, alt: str, width: int | None = None) -> Markup:
    """Return an image within the page; ``alt`` says in words what it shows."""
    return element("img", src=f"data:image/png;base64,{base64.b64encode(data).decode()}", alt=alt, width=width)


def figure(image: Markup, caption: str) -> Markup:
    """Return an image with a caption."""
    return element("figure", image, element("figcaption", caption))


def table(caption: str, heads: list[str], rows: list[list], *, numeric_from: int = 1) -> Markup:
    """Return a table whose columns from ``numeric_from`` on are numbers; the first cell of each row is its head."""
    kinds = ["number" if i >= numeric_from else None for i in range(len(heads))]
    top = element("tr", *(element("th", head, scope="col", class_=kind) for head, kind in zip(heads, kinds, strict=True)))
    lines = []
    for row in rows:
        first, *rest = zip(row, kinds, strict=True)
        cells = [element("th", first[0], scope="row"), *(element("td", cell, class_=kind) for cell, kind in rest)]
        lines.append(element("tr", *cells))
    kind = "short" if len(rows) <= SHORT else None
    return element("table", element("caption", caption), element("thead", top), element("tbody", *lines), class_=kind)


def facts(pairs: list[tuple[str, object]]) -> Markup:
    """Return a list of names and values."""
    return element("dl", *(part for name, value in pairs for part in (element("dt", name), element("dd", value))))


def section(title: str, *children, kind: str | None = None) -> Markup:
    """Return a section; ``kind`` "page" begins on a new page when printed, and "keep" stays on one."""
    return element("section", element("h2", title), *children, class_=kind)
