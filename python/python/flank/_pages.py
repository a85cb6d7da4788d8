"""Pictures and pages."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flank import _display
from flank._errors import InputError
from flank._quantities import names
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
        self._shown: dict[str, tuple[str, bytes]] | None = None

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
        if self._shown is None:
            self._shown = self._small()
        return _display.bundle_of(str(self), self._shown)

    def _small(self) -> dict[str, tuple[str, bytes]]:
        """What a notebook keeps of each picture, all of them together below its limit; what is larger is drawn again, smaller."""
        files = forms(self._files)
        # beside its bytes a picture has a name and a frame
        most = _display.MOST_BYTES // max(len(files), 1) - 300
        small: dict[str, tuple[str, bytes]] = {}
        drawn = files
        while True:
            small |= {name: picture for name, of in drawn.items() if (picture := _display.kept(of, most)) is not None}
            large = {name: drawn[name].get("png") for name in files if name not in small}
            sides = [_display.smaller(png, most) for png in large.values()]
            wanted = [size for size in sides if size is not None]
            if not wanted:
                return {name: small[name] for name in files if name in small}
            drawn = self._drawn_again(list(large), min(wanted))

    def _drawn_again(self, pictures: list[str], size: tuple[int, int]) -> dict[str, dict[str, bytes]]:
        kinds = [one["what"] for one in self._read()["pictures"]]
        what = [kind for kind in dict.fromkeys(kinds) if any(f".{kind}" in name for name in pictures)]
        with tempfile.TemporaryDirectory(prefix="flank-") as folder:
            self._again({"what": what, "size": size, "format": ["png"], "out": folder})
            drawn = forms(read(folder))
        return {name: drawn[name] for name in pictures}


def read(folder: str) -> dict[str, bytes]:
    """The files of a folder by their names."""
    return {file.name: file.read_bytes() for file in sorted(Path(folder).iterdir())}


def forms(files: Mapping[str, bytes]) -> dict[str, dict[str, bytes]]:
    """Pictures by their names: of each its forms by the endings of its files."""
    found: dict[str, dict[str, bytes]] = {}
    for name, content in files.items():
        picture, form = name.rsplit(".", 1)
        found.setdefault(picture, {})[form] = content
    return found


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


class Report(Page):
    """A page about a job, with all its numbers as document."""

    def write(self, folder: Path_, formats: str | Iterable[str] = ("html",)) -> list[str]:
        """Writes the page (html) and its text with pictures beside it (md)."""
        return self._write(folder, format=names(formats))
