#!/usr/bin/env bash
# distributed 2026.8.0 leaves a task waiting for ever whose preferred worker has died, though other workers are allowed.
# submit(..., workers=[address], allow_other_workers=True) says that the task may run elsewhere. If its worker is killed while
# there is no other one, the task comes to the state no-worker, and stays there when a new worker joins: that one runs other
# tasks, and not this one. (Issue 7346 of dask/distributed tells the same of tasks that allow no other worker.)
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'distributed==2026.8.0' 'dask==2026.8.0'
cat > "$folder/loose.py" <<'PYTHON'
import os
import signal
import time

import distributed
from distributed import Client, LocalCluster


def rest(seconds):
    time.sleep(seconds)
    return "done"


def state(dask_scheduler, key):
    return dask_scheduler.tasks[key].state


def main():
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "silence_logs": 50}
    with LocalCluster(**options) as cluster, Client(cluster) as client:
        (first,) = client.nthreads()
        loose = client.submit(rest, 3, workers=[first], allow_other_workers=True, pure=False)
        (process,) = client.run(os.getpid).values()
        time.sleep(0.5)
        os.kill(process, signal.SIGKILL)
        end = time.monotonic() + 60
        while not client.nthreads() or first in client.nthreads():  # its nanny starts another one
            assert time.monotonic() < end, "no new worker came"
            time.sleep(0.2)
        free = client.submit(rest, 1, pure=False).result(timeout=60)
        time.sleep(8)
        found = loose.status, client.run_on_scheduler(state, key=loose.key)
        print(f"distributed {distributed.__version__}: on the new worker a free task is {free}, the one before it {found}")
        assert (free, found) == ("done", ("pending", "no-worker")), "it has changed"


if __name__ == "__main__":
    main()
PYTHON
"$folder/venv/bin/python" "$folder/loose.py"
