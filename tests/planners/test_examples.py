"""The worked examples in docstrings say what happens."""

import doctest
import pkgutil
from importlib import import_module

import pytest

import planners

EXAMPLES = {
    module.name: [
        test for test in doctest.DocTestFinder().find(import_module(f"planners.{module.name}")) if test.examples
    ]
    for module in pkgutil.iter_modules(planners.__path__)
}


@pytest.mark.parametrize("name", [name for name, tests in EXAMPLES.items() if tests])
def test_worked_examples(name: str) -> None:
    runner = doctest.DocTestRunner(verbose=False)
    for test in EXAMPLES[name]:
        result = runner.run(test)
        assert result.failed == 0, test.name


def test_models_and_predictions_have_examples() -> None:
    assert {"belief", "motion", "evidence", "costs", "evaluation", "space"} <= {n for n, t in EXAMPLES.items() if t}
