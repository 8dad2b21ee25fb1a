"""docs/validation/index.md."""

from collections.abc import Sequence

from .comparison import ALPHA, Patchwise, Value, together

INTRODUCTION = f"""# Validation: what others say

`make validate` makes this page anew (`make validate ARGS=--quick` in about a minute, with fewer lines); `validation/` holds the
referees. Nothing here is compared with an earlier result of our own. Our side is always 16 independent runs, with seeds of
their own.

How to read it:

- **Scenes of any size**: `tests/test_scale.py` scales scenes by 1e-4 and 1e6, turns and moves them; they are cut, solved and
  reported alike (by powers of two, to the bit). So the lengths below stand for all.
- **t** is a difference in standard errors of the mean of the runs, **p** the chance of one as large if there were no error but
  noise (Student, 15 degrees of freedom). A comparison *disagrees* where p is below {ALPHA:g}.
- **chi-square** of patches is the mean over patches and bands of the squared difference over the variance that both sides state:
  ours from the standard errors of our solutions, the referee's from its 16 batches. About 1 is right. **expected** is the same as
  the scatter between runs makes it: it is 1 where the stated errors are true. Its p-value comes from flipping the signs of
  whole runs, since patches of one run share lines.
- **RMS** is the area-weighted RMS of the difference over that of the irradiance, beside what both sides' noise makes it.
- **rounding** (the books' word): what whole lines leave unsent after their residue has been sent on, less than a line a
  replicate but for what chance takes or gives (docs/errors.md, "Whole lines"). It is allowed for here by as much as the books of
  the runs say.
"""

ROW = "| {} | {:.6g} | {:.6g} | {:.1e} | {:+.2f} | {:.3f} | {} |"
PATCHES = "| {} | {} | {:.3f} | {:.3f} | {:.4f} | {:.2%} ({:.2%}) | {:+.2%} ± {:.2%} | {:.2%} | {} |"


def values(title: str, text: str, rows: Sequence[Value]) -> str:
    """A table of numbers against exact ones, and their p-values together."""
    lines = [
        f"## {title}",
        "",
        text,
        "",
        "| what | exact | measured | standard error | t | p | |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        notes = [f"± {row.bound:.1e} allowed"] if row.bound else []
        lines.append(
            ROW.format(row.name, row.exact, row.measured, row.error, row.t, row.p, "; ".join([*notes, row.note]).strip("; "))
        )
    p = together([row.p for row in rows])
    off = [row.name for row in rows if row.p < ALPHA]
    verdict = f"**disagree: {', '.join(off)}**" if off else "none disagrees"
    return "\n".join([*lines, "", f"{len(rows)} comparisons, {verdict}; p of all together: {p:.3f}.", ""])


def patches(title: str, text: str, rows: Sequence[Patchwise]) -> str:
    """A table of scenes, patch by patch."""
    lines = [
        f"## {title}",
        "",
        text,
        "",
        "| scene, method | patches x bands | chi-square | expected | p | RMS (noise) | mean | allowed | |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        verdict = "agrees" if r.agrees else "**disagrees**"
        lines.append(PATCHES.format(r.name, r.count, r.chi_square, r.expected, r.p, *r.rms, *r.mean, r.allowed, verdict))
    exact = [r for r in rows if not r.discrete]
    after = [] if not exact else [f"P of all together (particle tracing): {together([r.p for r in exact]):.3f}.", ""]
    return "\n".join([*lines, "", *after])
