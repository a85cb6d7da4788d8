"""All tests run from the root of the repository, where paths of specs begin."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PINION = "specs/bevel/pinion_19x62.chain"
PAIR = "specs/pairs/bevel_19x62.chain"


@pytest.fixture(autouse=True)
def _at_the_root(monkeypatch):
    monkeypatch.chdir(ROOT)


@pytest.fixture(scope="session")
def job():
    import flank

    return flank.load(ROOT / PINION)
