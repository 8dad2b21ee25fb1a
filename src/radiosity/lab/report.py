"""The report: one HTML file that opens from disk."""

import base64
import html
import platform
import re
from importlib.metadata import version
from pathlib import Path

from . import slopes
from .results import Results
from .study import Claim, Protocol

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
h1, h2 { line-height: 1.2; } table { border-collapse: collapse; font-size: 14px; margin: 1rem 0; }
td, th { padding: 2px 10px; text-align: right; border-bottom: 1px solid #ddd; }
td:first-child, th:first-child { text-align: left; }
.yes { color: #00693e; } .no { color: #b3261e; } .open { color: #6b5900; } svg { max-width: 100%; height: auto; }
img { max-width: 100%; } code { background: #f3f3f3; padding: 0 3px; } .scroll { overflow-x: auto; }
@media print { h2 { break-before: page; } }
"""
VERDICTS = {True: ("yes", "agrees"), False: ("no", "differs"), None: ("open", "reported")}
OURS = "Not in the paper"  # how claims begin that are not the paper's


def versions() -> str:
    """Return the versions of the programs that made the numbers."""
    names = ", ".join(f"{name} {version(name)}" for name in ("radiosity", "drjit", "mitsuba", "numpy"))
    return f"{names}; Python {platform.python_version()} on {platform.machine()}"


def page(sections: list[str], command: str, protocol: Protocol) -> str:
    """Return the whole report."""
    facts = (
        f"<p>Made by <code>{html.escape(command)}</code>. Ladder of 2<sup>10</sup> to 2<sup>{protocol.last}</sup> lines, "
        f"{protocol.replicates} replicates (independent randomisations) of every arm, seed {protocol.seed}; references of "
        f"{protocol.reference} times the lines of the last rung. {html.escape(versions())}.</p>"
    )
    counting = (
        "<p>Lines are counted as in the paper: a local line is one sample, a span of a global line two. Errors are RMS over "
        "patches of the radiosity less the true one, weighted by area, in the room relative to that of the reflected light. "
        "Slopes are fitted over the last two decades, replicate by replicate, with 95 % intervals (Student). Nothing is tuned to "
        "agree.</p>"
    )
    title = "An empirical comparison of Monte Carlo radiosity algorithms, reproduced"
    return (
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{title}</title><style>{STYLE}</style></head><body>"
        f"<h1>{title}</h1><p>After Ph. Bekaert, R. Cools and Y. D. Willems, <i>An empirical comparison of Monte Carlo radiosity "
        f"algorithms</i>.</p>{facts}{counting}{''.join(sections)}</body></html>"
    )


def section(number: int, title: str, question: str, parts: list[str]) -> str:
    """Return the section of one experiment."""
    return f"<h2>Experiment {number}: {html.escape(title)}</h2><p>{html.escape(question)}</p>{''.join(parts)}"


def findings(results: Results, claims: list[Claim]) -> str:
    """Return claims, errors of references, and the table behind the figure."""
    references = "".join(
        f"<p>Relative error of the reference of {html.escape(scene)}, {equation} equation: {error:.2g}.</p>"
        for (scene, equation), error in results.reference_error.items()
    )
    return f"{references}{verdicts(claims)}{_table(results)}"


def figure(path: Path) -> str:
    """Return a figure that was written as .svg, inlined: the report needs no other files."""
    text = path.with_suffix(".svg").read_text(encoding="utf-8")
    # in paths a hundredth of a point is exact enough; transforms keep every digit
    return re.sub(r' d="[^"]*"', _shorter, text[text.index("<svg") :])


def _shorter(path: re.Match) -> str:
    return re.sub(r"\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}", path[0])


def picture(path: Path) -> str:
    """Return a picture that was written as .png, inlined."""
    data = base64.b64encode(path.with_suffix(".png").read_bytes()).decode()
    return f"<img alt='{html.escape(path.name)}' src='data:image/png;base64,{data}'>"


def table(heads: list[str], rows: list[list[str]]) -> str:
    """Return a plain table."""
    lines = ["".join(f"<th>{html.escape(head)}</th>" for head in heads)]
    lines += ["".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows]
    return "<div class='scroll'><table>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table></div>"


def verdicts(claims: list[Claim]) -> str:
    """Return what the paper says, and whether this run agrees."""
    rows = []
    for claim in claims:
        kind, word = VERDICTS[claim.agrees]
        whose, _, says = claim.says.partition(": ")
        whose, says = (whose, says) if whose == OURS else ("The paper", claim.says)
        rows.append(
            f"<p><b>{whose}:</b> {html.escape(says)} <b class='{kind}'>This run: {word}.</b><br>{html.escape(claim.found)}</p>"
        )
    return "".join(rows)


def _table(results: Results) -> str:
    heads = ["scene", "arm", "slope (last two decades)", "error at the end", "plain RMS", "picture RMS", "lines", "seconds"]
    rows = []
    for (scene, arm), series in results.series.items():
        ends = [results.last(scene, arm), *(slopes.mean_error(errors)[-1] for errors in (series.plain, series.picture))]
        figures = [*ends, series.lines[-1], series.seconds[-1]]
        rows.append([scene, arm, str(results.slope(scene, arm)), *(f"{figure:.3g}" for figure in figures)])
    return table(heads, rows)
