"""Random BSDFs and area emitters of Mitsuba."""

from pathlib import Path

from .draw import Draw
from .images import save_png


def bsdf(draw: Draw, folder: Path, stem: str, words: str, *, textured: bool = True) -> str:
    """A BSDF; ``words`` are attributes of its outermost element."""
    if "twosided" in draw.features and draw.random() < 0.6:
        inner = _single(draw, folder, f"{stem}f", "", textured)
        if draw.has("two BSDFs", 0.2) and "bitmap" not in inner and "checkerboard" not in inner:
            inner += _single(draw, folder, f"{stem}b", "", textured=False)
        return f'<bsdf type="twosided"{words}>{inner}</bsdf>'
    return _single(draw, folder, stem, words, textured)


def _single(draw: Draw, folder: Path, stem: str, words: str, textured: bool) -> str:
    kinds = [("diffuse", "reflectance")]
    if "plastics" in draw.features:
        kinds += [("plastic", "diffuse_reflectance"), ("roughplastic", "diffuse_reflectance"), ("principled", "base_color")]
    kind, name = draw.one(*kinds)
    if "conductors" in draw.features and draw.random() < 0.3:
        return f'<bsdf type="roughconductor"{words}/>'
    return f'<bsdf type="{kind}"{words}>{_color(draw, folder, stem, name, textured)}</bsdf>'


def no_bsdf(draw: Draw) -> str:
    """Of a lamp: nothing, or one that lines pass through."""
    draw.features.add("lamps without a BSDF")
    return draw.one("", '<bsdf type="null"/>')


def emitter(draw: Draw, folder: Path, stem: str, *, textured: bool) -> str:
    if "constant spectra" in draw.features and draw.random() < 0.5:
        draw.features.add("constant radiance")
        return '<emitter type="area"><spectrum name="radiance" value="3.5"/></emitter>'
    if textured and "textures" in draw.features and draw.has("emission textures", 0.3):
        return f'<emitter type="area">{_bitmap(draw, folder, f"{stem}e", "radiance")}</emitter>'
    return f'<emitter type="area">{_rgb(draw, "radiance", 0.2, 8.0)}</emitter>'


def _color(draw: Draw, folder: Path, stem: str, name: str, textured: bool) -> str:
    if textured and "textures" in draw.features and draw.random() < 0.5:
        if draw.has("checkerboards", 0.4):
            one, two = _rgb(draw, "color0", 0.05, 0.9), _rgb(draw, "color1", 0.05, 0.9)
            return f'<texture type="checkerboard" name="{name}">{one}{two}{_to_uv(draw)}</texture>'
        return _bitmap(draw, folder, stem, name)
    if "spectra" in draw.features and draw.random() < 0.5:
        values = ", ".join(f"{w}:{v:.3f}" for w, v in zip((400, 500, 600, 700), draw.uniform(0.1, 0.8, 4), strict=True))
        return f'<spectrum name="{name}" value="{values}"/>'
    if "constant spectra" in draw.features and draw.random() < 0.5:
        return f'<spectrum name="{name}" value="{draw.uniform(0.1, 0.9):.3f}"/>'
    if "parameters" in draw.features and draw.random() < 0.4:
        return f'<rgb name="{name}" value="$tint, 0.3, 0.2"/>'
    return _rgb(draw, name, 0.05, 0.9)


def _rgb(draw: Draw, name: str, low: float, high: float) -> str:
    values = draw.uniform(low, high, 3)
    if "colours" not in draw.features:
        values[:] = values[0]
    return f'<rgb name="{name}" value="{", ".join(f"{v:.4f}" for v in values)}"/>'


def _bitmap(draw: Draw, folder: Path, stem: str, name: str) -> str:
    save_png(folder / f"{stem}.png", draw.image())
    more = _to_uv(draw)
    if draw.has("raw images", 0.2):
        more += '<boolean name="raw" value="true"/>'
    wrap, filtered = draw.one("repeat", "mirror", "clamp"), draw.one("bilinear", "nearest")
    draw.features |= {f"wrap {wrap}", f"filter {filtered}"}
    more += f'<string name="wrap_mode" value="{wrap}"/><string name="filter_type" value="{filtered}"/>'
    return f'<texture type="bitmap" name="{name}"><string name="filename" value="{stem}.png"/>{more}</texture>'


def _to_uv(draw: Draw) -> str:
    if not draw.has("texture transforms", 0.4):
        return ""
    scale = '<scale x="{:.3f}" y="{:.3f}"/>'.format(*draw.uniform(0.5, 2.5, 2))
    move = '<translate x="{:.3f}" y="{:.3f}"/>'.format(*draw.uniform(-1, 1, 2))
    turn = f'<rotate z="1" angle="{draw.uniform(0, 360):.2f}"/>' if draw.random() < 0.5 else ""
    return f'<transform name="to_uv">{scale}{turn}{move}</transform>'
