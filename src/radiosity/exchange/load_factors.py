"""Reading of the files of view factors."""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import SceneError
from ..solution.archive import check_sizes
from ..solution.npz import FACTORS, READERS, SOLUTION
from ..solution.reading import holds
from .factor_file import FORMAT, TEXTS
from .restoration import LEAST_SQUARES, RAW, SCALING
from .view_factors import ViewFactors

KINDS = {
    "rows": "i",
    "columns": "i",
    "hits": "i",
    "apart": "i",
    "values": "f",
    "errors": "f",
    "samples": "f",
    "line": "f",
    "area": "f",
}


def load_view_factors(path) -> ViewFactors:
    """Read view factors saved by `ViewFactors.to_npz`.

    Raises:
        SceneError: the file is missing, damaged, or holds something else.

    Example:
        >>> rd.view_factors(rd.load_scene("room"), rays=10_000).to_npz("factors.npz")
        >>> len(rd.load_view_factors("factors.npz"))
        10
    """
    path = Path(path)
    try:
        with path.open("rb") as opened:
            check_sizes(opened, path)
            with np.load(opened, allow_pickle=False) as file:
                meta = json.loads(str(file["meta"]))
                found = meta.get("kind", SOLUTION if "quanta" in meta else None)  # solutions say no kind
                if found != FACTORS and found in READERS:
                    raise SceneError(f"{path}: {holds(found)}, not view factors; {READERS[found]} reads it")
                if found != FACTORS or meta["format"] != FORMAT:
                    raise ValueError(f"kind '{meta.get('kind')}', format {meta.get('format')}")
                known = [field.name for field in fields(ViewFactors) if field.name not in TEXTS]
                arrays = {name: file[name] for name in known if name in file.files}
        texts: dict[str, Any] = {name: meta[name] for name in TEXTS} | {"names": tuple(meta["names"])}
        return _checked(ViewFactors(**{"samples": None, **arrays}, **texts))
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file; make view factors with -o {path.name} first") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from None
    except SceneError:
        raise
    except Exception as error:  # a damaged file of any kind must become a SceneError
        text = " ".join(str(error).split())[:200]
        raise SceneError(f"{path}: holds no view factors of this program, or is damaged ({text}); make them again") from None


def _checked(factors: ViewFactors) -> ViewFactors:
    """Return factors whose arrays fit each other.

    Raises:
        ValueError: they do not.
    """
    n, m = len(factors.names), len(factors.rows)
    shapes = {"area": (n,), "line": (n,), "samples": (factors.replicates, m), "apart": factors.apart.shape[:1]}
    for name, kind in KINDS.items():
        array = getattr(factors, name)
        if array is None:
            continue
        if array.dtype.kind != kind or array.shape != shapes.get(name, (m,)):
            raise ValueError(f"'{name}' is {array.dtype} {array.shape}")
    codes = factors.rows * (n + 2) + factors.columns
    good = m == 0 or (codes[0] >= 0 and (np.diff(codes) > 0).all() and factors.rows[-1] < n and (factors.columns < n + 2).all())
    good = good and not any((array < 0).any() for array in (factors.errors, factors.line)) and (factors.hits >= -1).all()
    good = good and (factors.columns >= 0).all() and np.abs(factors.row_sums - 1).max(initial=0) < 1e-6
    if not good or factors.restoration not in (RAW, LEAST_SQUARES, SCALING) or not (factors.area > 0).all():
        raise ValueError("rows that do not sum to one, or entries out of order")
    return factors
