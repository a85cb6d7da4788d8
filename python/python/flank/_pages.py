"""Pictures and pages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flank import _display
from flank._errors import InputError
from flank._results import PICTURES, Again, Path_, Result, put

if TYPE_CHECKING:
    from flank._flank import Answer


class Plot(Result):
    """A picture, or several.

    >>> import flank
    >>> picture = flank.load("specs/bevel/pinion_19x62.chain").plot("section")
    >>> "<svg" in picture.svg, picture.png[1:4]
    (True, b'PNG')
    """

    def __init__(self, answer: Answer, again: Again, inside: str, files: Mapping[str, bytes]) -> None:
        super().__init__(answer, again, inside)
        self._files = dict(files)

    @property
    def pictures(self) -> dict[str, dict[str, bytes]]:
        """Of each kind of picture its `svg` and its `png`."""
        kinds = [one["what"] for one in self._read()["pictures"]]
        names_of = {kind: [name for name in self._files if f".{kind}." in name] for kind in kinds}
        return {kind: {name.rsplit(".", 1)[-1]: self._files[name] for name in found} for kind, found in names_of.items()}

    def _one(self, form: str) -> bytes:
        pictures = self.pictures
        if len(pictures) != 1:
            raise InputError(f"there are {len(pictures)} pictures ({', '.join(pictures)}): take one of `pictures`")
        return next(iter(pictures.values()))[form]

    @property
    def svg(self) -> str:
        """The one picture as SVG."""
        return self._one("svg").decode()

    @property
    def png(self) -> bytes:
        """The one picture as PNG."""
        return self._one("png")

    def save(self, path: Path_) -> str:
        """Writes the one picture, SVG or PNG as the path ends, and gives the path."""
        form = Path(path).suffix.lower().lstrip(".")
        if form not in PICTURES:
            raise InputError(f"`{path}` ends in neither .svg nor .png")
        put(Path(path), self._one(form))
        return str(path)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        first = next(iter(self.pictures.values()), {})
        svg = first["svg"].decode() if "svg" in first else None
        return _display.bundle(str(self), svg, first.get("png"))


class Page(Result):
    """A page of HTML: the job in 3-D, or a report. A notebook shows it in a frame; nothing of it is loaded from elsewhere."""

    def __init__(self, answer: Answer, again: Again, inside: str, html: str, height: int) -> None:
        super().__init__(answer, again, inside)
        self.html = html
        self.height = height

    def save(self, path: Path_) -> str:
        """Writes the page and gives its path."""
        put(Path(path), self.html.encode())
        return str(path)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": str(self), "text/html": _display.frame(self.html, self.height)}
