"""Every function and every method of jobs has an example, and all examples do what they say."""

import doctest
import importlib
import inspect
from pathlib import Path

import pytest

import flank

MODULES = ["flank", *(f"flank.{path.stem}" for path in sorted(Path(flank.__file__).parent.glob("_[a-z]*.py")))]


@pytest.mark.parametrize("module", MODULES)
def test_examples_of(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.failed == 0


def test_all_that_is_public_is_described():
    functions = [of for name in flank.__all__ if inspect.isfunction(of := getattr(flank, name))]
    methods = [of for name, of in vars(flank.Job).items() if inspect.isfunction(of) and not name.startswith("_")]
    assert len(functions) + len(methods) > 25
    for of in functions + methods:
        assert of.__doc__ and ">>>" in of.__doc__, of.__qualname__
    for name in flank.__all__:
        kind = getattr(flank, name)
        members = vars(kind).items() if inspect.isclass(kind) else []
        for member, of in members:
            shown = of.fget if isinstance(of, property) else of
            if inspect.isfunction(shown) and not member.startswith("_"):
                assert shown.__doc__, f"{name}.{member}"
