"""Certifies the cases of a folder and holds each certificate against scripts/independent.py, and
against the events of IDA at 1e-13 with short steps.

Usage: campaign_certificates.py FREEPLAY FOLDER, from the project's root; FOLDER/*.toml are the cases
(campaign.sh writes them), result files go beside them. A line a case; at the end what fell."""

import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

PATIENCE = 900  # s, of a certificate and of an integration
SAMPLES = 40


def command(*words):
    try:
        return subprocess.run(
            [str(word) for word in words], capture_output=True, text=True, timeout=PATIENCE
        )
    except subprocess.TimeoutExpired:
        return None


def last_line(done):
    return (done.stderr.strip().splitlines() or ["it says nothing"])[-1]


def judge(freeplay, path):
    """What fell, in words beginning with its kind."""
    case = tomllib.loads(path.read_text())
    until = case["run"]["duration"]
    certified = path.with_suffix(".h5")
    every = f"run.sample_interval={until / SAMPLES:.6e}"
    words = ["certify", path, "--quiet", "--force", "-o", certified, "--set", every]
    done = command(freeplay, *words)
    if done is None:
        return [f"certificate not done: after {PATIENCE} s"]
    if not certified.exists():
        return [f"refused: {last_line(done)}"]
    fell = []
    if done.returncode not in (0, 1):
        fell.append(f"refused: {last_line(done)}")
    with h5py.File(certified) as file:
        end = file["time"][-1]
        flies = (file["in_contact"][:] == 0) & (file["penetration"][:] > 1e-12)
    if flies.any():
        fell.append("in the wall: a certified sample")
    if end < 0.999 * until:
        fell.append(f"short: certified until {end:e} of {until:e} s")
    script = Path(__file__).with_name("independent.py")
    integrated = command(sys.executable, script, path, "--until", end, "--against", certified)
    if integrated is None or integrated.returncode not in (0, 1):
        fell.append("unjudged: the independent integration did not come to its end")
    elif integrated.returncode == 1:
        fell.append(f"claim above the truth: {integrated.stdout.strip().splitlines()[-1]}")
    return fell + against_ida(freeplay, path, certified, end)


def against_ida(freeplay, path, certified, end):
    """Contacts of IDA with short steps, held against those certified while ten digits are."""
    result = path.with_suffix(".ida.h5")
    keys = ["relative_tolerance=1e-13", f"max_step={end / 2000:.3e}"]
    sets = [word for key in keys for word in ("--set", f"solver.{key}")]
    done = command(freeplay, "run", path, "--quiet", "--force", "-o", result, *sets)
    if done is None or done.returncode:
        return [f"ida: {'not done' if done is None else last_line(done)}"]
    with h5py.File(certified) as ours, h5py.File(result) as theirs:
        grown = ours["error_growth"][:] if "error_growth" in ours else None
        sure = end if grown is None else last_sure(ours["time"][:], grown)
        begins = [np.sort(f["contact_begin"][:]) for f in (ours, theirs)]
        begins = [of[of < 0.98 * sure] for of in begins]
    if len(begins[0]) != len(begins[1]):
        counts = f"{len(begins[0])} contacts certified, {len(begins[1])} in IDA, until {sure:e} s"
        return [f"contacts: {counts}"]
    return []


def last_sure(times, grown):
    """Until when an error of 1e-12 stays below 1e-4."""
    sure = times[: len(grown)][grown < 1e6]
    return sure[-1] if len(sure) else 0.0


def main():
    freeplay, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    paths = sorted(folder.glob("*.toml"))
    kinds = {}
    with ThreadPoolExecutor(2) as pool:
        for path, fell in zip(paths, pool.map(lambda path: judge(freeplay, path), paths)):
            print(f"{path.stem}: {'; '.join(fell) or 'holds'}", flush=True)
            for words in fell:
                kinds.setdefault(words.split(":")[0], []).append(path.stem)
    print(f"{len(paths)} certificates")
    for kind, names in sorted(kinds.items()):
        print(f"{len(names):5}  {kind}: {' '.join(names[:8])}")
    return 1 if kinds.get("claim above the truth") or kinds.get("in the wall") else 0


if __name__ == "__main__":
    sys.exit(main())
