"""Every public name says what it takes, holds and raises."""

import dataclasses
import inspect
import re
from types import ModuleType

import pytest

import discretize
import geomsim
import geomsim.trials
import maps
import planners

PUBLIC = [
    pytest.param(package, name, id=f"{package.__name__}.{name}")
    for package in (maps, discretize, planners, geomsim, geomsim.trials)
    for name in package.__all__
]


def mentions(text: str, name: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text) is not None


@pytest.mark.parametrize(("package", "name"), PUBLIC)
def test_public_names_are_documented(package: ModuleType, name: str) -> None:
    thing = getattr(package, name)
    if not (inspect.isclass(thing) or inspect.isfunction(thing)):
        return  # a table or an alias, whose docstring is in its module's source
    text = inspect.getdoc(thing) or ""
    assert len(text) > 20
    if inspect.isfunction(thing):
        assert_parameters(thing, text)
        return
    if dataclasses.is_dataclass(thing):
        missing = [
            f.name for f in dataclasses.fields(thing) if not f.name.startswith("_") and not mentions(text, f.name)
        ]
        assert not missing, f"fields without a word: {missing}"
    for member, function in vars(thing).items():
        if inspect.isfunction(function) and not member.startswith("_"):
            assert inspect.getdoc(function), f"{name}.{member} has no docstring"
    own_init = "__init__" in vars(thing) and not getattr(thing, "_is_protocol", False)
    if own_init and not dataclasses.is_dataclass(thing):
        assert_parameters(thing.__init__, text)


def assert_parameters(function, text: str) -> None:
    names = [p for p in inspect.signature(function).parameters if p not in ("self", "cls")]
    missing = [p for p in names if not mentions(text, p)]
    assert len(missing) <= (1 if len(names) == 1 else 0), f"parameters without a word: {missing}"
    units = {"speed": "metres a second", "radius": "metres", "resolution": "metres", "duration": "seconds"}
    for parameter in set(names) & set(units):
        assert units[parameter] in text.lower(), f"{parameter} has no unit"


def raises_itself(function) -> bool:
    return re.search(r"^\s+raise \w*Error\(", inspect.getsource(function), re.MULTILINE) is not None


@pytest.mark.parametrize(("package", "name"), PUBLIC)
def test_what_is_raised_is_told(package: ModuleType, name: str) -> None:
    thing = getattr(package, name)
    if inspect.isfunction(thing) and raises_itself(thing):
        assert re.search(r"Raises|\w*Error", inspect.getdoc(thing) or ""), "its errors are not told"
