"""What the page tells about its subject, as Markdown."""

from collections.abc import Iterable

from ..diagnostics.report import Finding, surface_rows
from ..patches import subdivide
from .numbers import plain
from .subject import Subject

MOST_SURFACES = 300  # rows of the table


def text(subject: Subject, findings: Iterable[Finding] = (), marks: Iterable[str] = ()) -> str:
    """Return what is known: the report of a solution, or what a scene holds and what in it is probably not meant.

    Args:
        subject: what is shown.
        findings: of `check`.
        marks: lines about what is no surface.
    """
    scene, parts = subject.patches.scene, []
    if subject.solution is not None:
        parts.append(_fenced(subject.solution.report()))
    else:
        parts.append(f"**not solved yet**: {plain(scene.source)}, {scene.n_faces:,} faces, {len(subject.patches):,} patches")
        parts += [f"**{one.severity}**, {plain(one.kind)}: {plain(one.message)}" for one in findings]
        parts.append(_table(subject))
    parts += [plain(line) for line in marks]
    parts.append("Drag to turn, W A S D Q E to walk, wheel to come nearer, right button to move.")
    return "\n\n".join(parts)


def _table(subject: Subject) -> str:
    scene = subject.patches.scene
    rows = surface_rows(subdivide(scene, cells=1))
    lines = ["| surface | area m² | reflectance | emission |", "|---|---|---|---|"]
    for row in rows[:MOST_SURFACES]:
        means = (", ".join(f"{value:.3g}" for value in values) for values in (row.reflectance, row.emission))
        lines.append(f"| {plain(row.name)} | {row.area:.4g} | {' | '.join(means)} |")
    if len(rows) > MOST_SURFACES:
        lines.append(f"| and {len(rows) - MOST_SURFACES} more | | | |")
    return "\n".join(lines)


def _fenced(report: str) -> str:
    """Return lines as they are; names of a file cannot end the block."""
    return "```\n" + report.replace("`", "'") + "\n```"
