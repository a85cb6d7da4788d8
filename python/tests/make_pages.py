"""The notebooks as pages of the book: text, code, what it prints, and pictures beside it.

    python python/tests/make_pages.py
"""

from __future__ import annotations

import re
from pathlib import Path

import nbformat

ROOT = Path(__file__).parents[2]


def _output(output: nbformat.NotebookNode, pictures: list[str], stem: str) -> str:
    if output.output_type == "stream":
        return f"```text\n{''.join(output.text).rstrip()}\n```"
    data = output.get("data", {})
    if "image/svg+xml" in data:
        pictures.append("".join(data["image/svg+xml"]))
        return f"![{stem}](../images/{stem}_{len(pictures)}.svg)"
    return f"```text\n{''.join(data.get('text/plain', '')).rstrip()}\n```"


def page(path: Path, pictures: list[str] | None = None) -> str:
    """A notebook as Markdown; its pictures go into the list."""
    pictures = [] if pictures is None else pictures
    parts = []
    for cell in nbformat.read(path, as_version=4).cells:
        source = "".join(cell.source).strip()
        if cell.cell_type == "markdown":
            # paths in a notebook begin beside it
            parts.append(re.sub(r"\.\./\.\./docs/", "../", source))
        elif source:
            parts.append(f"```py\n{source}\n```")
            parts += [_output(output, pictures, path.stem) for output in cell.get("outputs", [])]
    end = f"This page is made from the notebook `python/notebooks/{path.name}`."
    return "\n\n".join([*parts, end]) + "\n"


def main() -> None:
    """Writes all pages."""
    for path in sorted((ROOT / "python/notebooks").glob("*.ipynb")):
        pictures: list[str] = []
        text = page(path, pictures)
        (ROOT / "docs/notebooks" / f"{path.stem}.md").write_text(text)
        for number, picture in enumerate(pictures, 1):
            (ROOT / "docs/images" / f"{path.stem}_{number}.svg").write_text(picture)


if __name__ == "__main__":
    main()
