"""What notebooks show: text, and a picture below 200 kB."""

from __future__ import annotations

import base64
import html
import math
import struct
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from flank._points import Floats, SurfacePoints

MOST_BYTES = 200_000
SVG = "image/svg+xml"
PNG = "image/png"
# of a picture that is drawn again, at first and at the least
_SIDES = (1000, 750)
_LEAST_SIDE = 150
_WIDTH = 480
_LINES = 41
_COLOURS = ("#1f5fa8", "#b5472f", "#3b7d4f", "#7d5ba6", "#8a6d1d")


def bundle(text: str, svg: str | None = None) -> dict[str, str]:
    """A bundle of types that notebooks choose from; a picture that is too large is left out."""
    shown = {"text/plain": text}
    if svg is not None and len(svg.encode()) < MOST_BYTES:
        shown["image/svg+xml"] = svg
    return shown


def bundle_of(text: str, pictures: Mapping[str, tuple[str, bytes]]) -> dict[str, str]:
    """The same of one picture, or of several on a page below each other: of each its type and its bytes, by its name."""
    if len(pictures) == 1:
        ((kind, content),) = pictures.values()
        return {"text/plain": text, kind: content.decode() if kind == SVG else base64.b64encode(content).decode()}
    if not pictures:
        return {"text/plain": text}
    return {"text/plain": text, "text/html": "".join(_image(name, *of) for name, of in pictures.items())}


def _image(name: str, kind: str, content: bytes) -> str:
    return f'<p><img alt="{html.escape(name)}" src="data:{kind};base64,{base64.b64encode(content).decode()}"/></p>'


def kept(forms: Mapping[str, bytes], most: int) -> tuple[str, bytes] | None:
    """The form of a picture that takes less than so many bytes in a notebook, with its type; SVG before PNG."""
    # base64 has four letters for three bytes
    small = [(kind, forms[form]) for form, kind in (("svg", SVG), ("png", PNG)) if len(forms.get(form, b"")) * 4 // 3 < most and form in forms]
    return small[0] if small else None


def smaller(png: bytes | None, most: int) -> tuple[int, int] | None:
    """Sides with which a picture may take less than so many bytes in a notebook; none where it would be too small to see."""
    if png is None:
        return _SIDES
    # the header of a PNG has its width and its height
    sides = struct.unpack(">II", png[16:24])
    shrunk = min(0.9, 0.95 * math.sqrt(0.75 * most / len(png)))
    width, height = (int(side * shrunk) for side in sides)
    return (width, height) if min(width, height) >= _LEAST_SIDE else None


def table(rows: Sequence[Sequence[str]], head: Sequence[str]) -> str:
    """Rows as a table of HTML."""
    cells = "".join(f"<th style='text-align:left'>{html.escape(cell)}</th>" for cell in head)
    lines = "".join(
        "<tr>" + "".join(f"<td style='text-align:left'>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """Rows as text with their cells below each other."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))] if rows else []
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows)


def outline(grids: Sequence[SurfacePoints]) -> str:
    """Rows and columns of surfaces as lines, seen from above one corner."""
    # from x, y, z to right and down
    view = np.array([[-0.707, 0.707, 0.0], [0.408, 0.408, -0.816]])
    lines = [(k, view @ line.T) for k, grid in enumerate(grids) for line in _lines(grid.xyz)]
    if not lines:
        return _svg(_WIDTH, 40, "<text x='8' y='24'>no points</text>")
    every = np.concatenate([line for _, line in lines], axis=1)
    low, high = every.min(axis=1), every.max(axis=1)
    scale = (_WIDTH - 20) / max(high[0] - low[0], (high[1] - low[1]) / 1.2, 1e-9)
    height = int((high[1] - low[1]) * scale) + 40
    drawn = []
    for k, line in lines:
        x, y = (line - low[:, None]) * scale + 10
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
        colour = _COLOURS[k % len(_COLOURS)]
        drawn.append(f"<polyline fill='none' stroke='{colour}' stroke-width='0.7' points='{points}'/>")
    names = "  ".join(f"<tspan fill='{_COLOURS[k % len(_COLOURS)]}'>{html.escape(of.name)} </tspan>" for k, of in enumerate(grids))
    label = f"<text x='10' y='{height - 8}' font-size='12' font-family='sans-serif'>{names}</text>"
    return _svg(_WIDTH, height, "".join(drawn) + label)


def _lines(xyz: Floats) -> list[Floats]:
    rows, columns = (np.unique(np.linspace(0, n - 1, min(n, _LINES)).astype(int)) for n in xyz.shape[:2])
    thin = xyz[np.ix_(rows, columns)]
    both = [*thin, *thin.swapaxes(0, 1)]
    known = [line[~np.isnan(line[:, 0])] for line in both]
    return [line for line in known if len(line) > 1]


def heights(values: Floats, unit: str, labels: tuple[str, str], title: str) -> str:
    """A map of numbers over rows and columns: red above zero, blue below; the last row on top."""
    most = float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
    rows, columns = values.shape
    step_i, step_j = -(-rows // _LINES), -(-columns // (2 * _LINES))
    shown = values[::step_i, ::step_j]
    rows, columns = shown.shape
    side = (_WIDTH - 20) / columns
    tall = min(side, 220 / rows)
    cells = []
    for i in range(rows):
        for j in range(columns):
            value = shown[i, j]
            fill = "#ddd" if np.isnan(value) else _colour(value / most if most else 0.0)
            x, y = 10 + j * side, 24 + (rows - 1 - i) * tall
            cells.append(f"<rect x='{x:.1f}' y='{y:.1f}' width='{side + 0.3:.1f}' height='{tall + 0.3:.1f}' fill='{fill}'/>")
    height = int(24 + rows * tall + 40)
    low, high = (float(np.nanmin(values)), float(np.nanmax(values))) if most or np.isfinite(values).any() else (0.0, 0.0)
    words = f"{low:.3f} to {high:.3f} {unit}; up: {labels[0]}, right: {labels[1]}"
    text = "font-size='12' font-family='sans-serif'"
    captions = (
        f"<text x='10' y='15' {text}>{html.escape(title)}</text>"
        f"<text x='10' y='{height - 12}' {text}>{html.escape(words)}</text>"
    )
    return _svg(_WIDTH, height, "".join(cells) + captions)


def _colour(share: float) -> str:
    strong = np.array([178, 34, 34]) if share > 0 else np.array([31, 95, 168])
    mixed = (1 - abs(share)) * np.array([247, 247, 247]) + abs(share) * strong
    return "#" + "".join(f"{int(round(channel)):02x}" for channel in mixed)


def _svg(width: int, height: int, inner: str) -> str:
    return (
        f"<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}' viewBox='0 0 {width} {height}'>"
        f"{inner}</svg>"
    )


def frame(page: str, height: int) -> str:
    """A page of HTML in a frame."""
    inside = html.escape(page, quote=True)
    return f'<iframe srcdoc="{inside}" width="100%" height="{int(height)}" style="border:0" sandbox="allow-scripts"></iframe>'


def shown_number(value: Any) -> str:
    """A number as people read it."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
