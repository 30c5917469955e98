#!/usr/bin/env python3
"""How cost grows with a mechanism: chains of N four-bars, made, checked and run.

    scripts/sizes.py [FREEPLAY] [COUNT ...]

Prints a row for each N: CPU of `check` (s), and for each engine at 1e-9 the CPU of a step (µs), from runs to
0.1 and to 0.6 s, and the memory at most (MB).
"""

import os
import re
import subprocess
import sys
import tempfile


def run(*arguments):
    """CPU seconds, peak memory (MB) and output of a command."""
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen(arguments, stdout=out, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
        out.seek(0)
        said = out.read()
    if status != 0:
        sys.exit(f"{' '.join(arguments)}: {said}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, said


def main():
    freeplay = sys.argv[1] if len(sys.argv) > 1 else "target/release/freeplay"
    counts = sys.argv[2:] or ["2", "10", "50", "100", "200", "500", "1000"]
    print("    N   check    IDA step   explicit step   memory")
    with tempfile.TemporaryDirectory() as folder:
        for count in counts:
            case, result = f"{folder}/chain.toml", f"{folder}/chain.h5"
            run(freeplay, "new", "four-bars", "--count", count, "-o", case, "--force")
            check = run(freeplay, "check", case)[0]
            row, most = [], 0.0
            for engine in ["ida", "explicit"]:
                least = {}
                for duration in ["0.1", "0.6"] * 3:
                    keys = [f"run.duration={duration}", f"solver.engine={engine}"]
                    keys += ["solver.relative_tolerance=1e-9", "run.sample_interval=0.1"]
                    changes = [word for key in keys for word in ("--set", key)]
                    command = [freeplay, "run", case, "-o", result, "--force", "--quiet"]
                    seconds, memory, said = run(*command, *changes)
                    steps = int(re.search(r"(\d+) steps", said)[1])
                    least[duration] = min(least.get(duration, (seconds, steps)), (seconds, steps))
                    most = max(most, memory)
                (short, few), (long, many) = least["0.1"], least["0.6"]
                row.append((long - short) / (many - few) * 1e6)
            print(f"{count:>5} {check:7.2f} {row[0]:11.0f} {row[1]:15.0f} {most:8.0f}")


if __name__ == "__main__":
    main()
