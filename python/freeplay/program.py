"""Runs of the program."""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from decimal import Decimal
from numbers import Integral
from pathlib import Path

import xarray

from freeplay.result import open


class ProgramError(RuntimeError):
    """The program did not do what was asked for; `code` is its exit code, the words are its own."""

    def __init__(self, code: int, words: str):
        super().__init__(words.strip() or f"freeplay ended with exit code {code}")
        self.code = code


def run(
    case: str | os.PathLike,
    output: str | os.PathLike | None = None,
    *,
    ideal: bool = False,
    force: bool = False,
    changes: Mapping[str, object] | None = None,
    **more_changes,
) -> xarray.Dataset:
    """Runs a case with the program, and opens the result.

    Keys of the case are changed by name: `run(case, run={"duration": 0.02})`, or by their dotted
    paths: `run(case, changes={"run.duration": 0.02})`. `ideal` removes every clearance. Without
    `output` the result is read into memory and no file stays; with one it is written there, and
    `force` replaces what is there.
    """
    settings = {**flat(changes or {}), **flat(more_changes)}
    arguments = ["run", os.fspath(case), "--quiet"]
    arguments += [f"--set={key}={toml(key, value)}" for key, value in settings.items()]
    arguments += ["--ideal"] * ideal + ["--force"] * force
    if output is not None:
        call([*arguments, "-o", os.fspath(output)])
        return open(output)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        call([*arguments, "-o", os.fspath(path)])
        with open(path) as result:
            return result.load()


def call(arguments: list[str]) -> str:
    """What the program says on standard output."""
    done = subprocess.run([program(), *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        raise ProgramError(done.returncode, done.stderr)
    return done.stdout


def program() -> str:
    """Path of the program."""
    beside = Path(__file__).resolve().parents[2] / "target/release/freeplay"
    found = os.environ.get("FREEPLAY") or shutil.which("freeplay") or beside
    if not Path(found).is_file():
        raise FileNotFoundError(
            f"there is no program {found}: put freeplay on the path, or name it in FREEPLAY"
        )
    return os.fspath(found)


def flat(changes: Mapping[str, object], above: str = "") -> dict[str, object]:
    """Changes by dotted path, from tables within tables."""
    paths = {}
    for key, value in changes.items():
        if isinstance(value, Mapping):
            paths |= flat(value, f"{above}{key}.")
        else:
            paths[f"{above}{key}"] = value
    return paths


def toml(key: str, value: object) -> str:
    """A value as a case file has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(toml(key, item) for item in value)}]"
    if isinstance(value, (Integral, Decimal)):
        return str(value)
    if hasattr(value, "__float__"):
        return repr(float(value))
    raise TypeError(f"{key}: a case file has no value like {value!r}")
