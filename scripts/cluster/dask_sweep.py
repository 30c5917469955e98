"""Makes a study on the workers of a dask cluster: `freeplay sweep` in shards, gathered at the end.

    python scripts/cluster/dask_sweep.py STUDY.toml -o DIR --scheduler-file cluster.json
    python scripts/cluster/dask_sweep.py STUDY.toml -o DIR --workers 4

The workers share a disk with whoever starts this, and have the program under the same name. A shard
whose worker dies is made again by another one, and so is one that ends with 75: what was done of it is
kept, and nothing is done twice. Runs that fail are rows of `failures`, and are not tried again.
Ends with the exit code of `freeplay sweep --gather`; with 1 where a shard cannot be made.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from distributed import Client, LocalCluster, as_completed

TRY_AGAIN = 75
SOME_RUNS_FAILED = 4


class TryAgain(Exception):
    """A shard was stopped by a signal, or its disk was full."""


def make_shard(program: str, study: str, folder: str, number: int, count: int) -> tuple[int, str]:
    """Makes a shard on a worker; gives its exit code and what it said."""
    shard = [program, "sweep", study, "--shard", f"{number}/{count}", "-o", folder]
    done = subprocess.run([*shard, "--jobs", "1", "--quiet"], capture_output=True, text=True)
    # a shard that a signal ended without its say is no other
    if done.returncode == TRY_AGAIN or done.returncode < 0:
        raise TryAgain(f"shard {number}/{count}: {done.stderr.strip()}")
    return done.returncode, done.stderr.strip()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for the tables")
    parser.add_argument("--shards", type=int, help="default: eight for each worker")
    parser.add_argument("--retries", type=int, default=3, help="of a shard that can be tried again")
    parser.add_argument("--freeplay", default="freeplay", help="the program")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", help="address of a running scheduler")
    where.add_argument("--scheduler-file", help="file that a running scheduler wrote")
    where.add_argument("--workers", type=int, help="processes of one's own on this machine")
    arguments = parser.parse_args()

    study, folder = str(arguments.study.resolve()), str(arguments.output.resolve())
    if arguments.workers:
        cluster = LocalCluster(
            n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None
        )
        client = Client(cluster)
    else:
        client = Client(arguments.scheduler, scheduler_file=arguments.scheduler_file)
    with client:
        client.wait_for_workers(1)
        workers = len(client.scheduler_info()["workers"])
        count = arguments.shards or 8 * workers
        shards = [
            client.submit(
                make_shard, arguments.freeplay, study, folder, number, count,
                retries=arguments.retries, pure=False,
            )
            for number in range(1, count + 1)
        ]  # fmt: skip
        for shard in as_completed(shards):
            try:
                code, said = shard.result()
            except Exception as error:  # what a worker could not do, after all its tries
                code, said = 1, f"{type(error).__name__}: {error}"
            if code not in (0, SOME_RUNS_FAILED):
                print(f"error: {said}", file=sys.stderr)
                return 1
    gather = [arguments.freeplay, "sweep", study, "--gather", folder]
    return subprocess.run(gather).returncode


if __name__ == "__main__":
    sys.exit(main())
