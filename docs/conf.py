"""Settings of the documentation site: `make docs` builds it into build/docs. Nothing is downloaded while it builds."""

import re
from pathlib import Path

import radiosity

project = "radiosity"
author = "The radiosity developers"
copyright = author
version = release = radiosity.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
html_theme = "furo"
html_title = f"radiosity {release}"
html_extra_path = ["report.html"]  # the study's report, a page of its own
html_copy_source = False
html_show_copyright = False

myst_heading_anchors = 4  # links such as errors.md#whole-lines, with the anchors that a forge makes
myst_links_external_new_tab = False
suppress_warnings = ["myst.xref_ambiguous"]

napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_attr_annotations = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say types, shapes and units
autodoc_preserve_defaults = True

# Pages link to files beside this folder, as on a forge. The site has a page for each of these.
OUTSIDE = {
    "README.md": "start.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "reporting.md",
    "CODE_OF_CONDUCT.md": "conduct.md",
}
LINK = re.compile(r"\]\(((?:\.\./)+)(" + "|".join(map(re.escape, OUTSIDE)) + r")(#[^)]*)?\)")


def inside(app, docname: str, source: list[str]) -> None:
    """Turn links to files beside this folder into links to their pages."""
    depth = docname.count("/")

    def link(match: re.Match) -> str:
        up, name, anchor = match.groups()
        if up.count("../") != depth + 1:
            return match.group()
        return f"]({'../' * depth}{OUTSIDE[name]}{anchor or ''})"

    source[0] = LINK.sub(link, source[0])


def included(app, relative_path: Path, parent: str, content: list[str]) -> None:
    """The same for included files, whose links begin with ``docs/`` or name a file beside them."""
    text = re.sub(r"\]\(docs/", "](", content[0])
    content[0] = re.sub(
        r"\]\((" + "|".join(map(re.escape, OUTSIDE)) + r")(#[^)]*)?\)",
        lambda match: f"]({OUTSIDE[match[1]]}{match[2] or ''})",
        text,
    )


def several(app, what, name, value, options, lines: list[str]) -> None:
    """Mend what napoleon makes of our docstrings: ``rays, seconds: text`` means several names and no type, and so does the
    beginning of a property's text, ``(n_faces,) m², of one side: text``."""
    names = re.compile(r"^(:(?:param|ivar) )([^:]+, [^:]+)(:.*)")
    lines[:] = [names.sub(lambda m: m[1] + m[2].replace(", ", ",\u200b") + m[3], line) for line in lines]
    kinds = [place for place, line in enumerate(lines) if line.startswith(":type: ")]
    if what in ("attribute", "property") and kinds:
        lines[0] = f"{lines[kinds[-1]].removeprefix(':type: ')}: {lines[0]}"
        del lines[kinds[-1]]


def setup(app) -> None:
    app.connect("autodoc-process-docstring", several, priority=900)  # after napoleon
    app.connect("source-read", inside)
    app.connect("include-read", included)
