"""What a result file must hold, as the test that wrote it says."""

import math
import sys
from dataclasses import dataclass


@dataclass
class Dataset:
    """A dataset: its dimensions, their lengths, its unit, its values row by row."""

    name: str
    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    unit: str
    values: list[float]

    def check_values(self, found) -> None:
        """Stops unless `found` has these values to the last bit."""
        found = [float(value) for value in found]
        check(self.name, "number of values", len(found), len(self.values))
        for k, (a, b) in enumerate(zip(found, self.values)):
            if a != b and not (math.isnan(a) and math.isnan(b)):
                raise SystemExit(f"{self.name}: value {k} is {a!r}, written was {b!r}")


def check(name: str, what: str, found, expected) -> None:
    """Stops unless both are equal."""
    if found != expected:
        raise SystemExit(f"{name}: {what} is {found!r}, should be {expected!r}")


def text(value) -> str:
    """Text of an attribute, which some readers give as bytes."""
    return value.decode() if isinstance(value, bytes) else str(value)


def arguments() -> tuple[str, list[Dataset], str]:
    """The result file, what it must hold and the case's text, from the command line."""
    result, expected, case = sys.argv[1:4]
    datasets = []
    with open(expected, encoding="utf-8") as lines:
        for line in lines:
            name, dimensions, shape, unit, values = line.rstrip("\n").split("\t")
            datasets.append(
                Dataset(
                    name,
                    tuple(dimensions.split()),
                    tuple(int(length) for length in shape.split()),
                    unit,
                    [float(value) for value in values.split()],
                )
            )
    with open(case, encoding="utf-8") as file:
        return result, datasets, file.read()
