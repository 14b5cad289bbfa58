# SPDX-License-Identifier: BSD-3-Clause
"""Many jobs on many processors or machines: meshes compiled, data sets queried, scenes and settings swept. A manifest
in, a row for each job out. Called again, what is done is not done again; a worker that dies loses nothing.

    python3 -m dynpoint.bulk compile MANIFEST RESULTS.tsv --unit mm --workers 2
    python3 -m dynpoint.bulk query MANIFEST RESULTS.tsv --scheduler tcp://ADDRESS:8786

Manifests are lines with tabs between; empty lines and those that begin with # are skipped:

    compile  SOURCE       OUT.dpa                            as `dynpoint compile --list` has it
    query    MESH.dpa     OUT.npy   ENDS.npy                 ends (n, 6) of float64; out: structs of HIT
    sweep    SCENE        OUT.npy   POSES.npy   SETTINGS     poses (n, 7), settings in JSON; out: wrenches (n, 6)

The table of results has a line for each, in the manifest's order: what was read, OUT, a verdict (DPT_OK or an error's
name), SHA-256 of OUT, seconds, and a note. It is as that of `dynpoint compile --list`, but for the first line, which has
the settings; of compile the first four columns are the same, and so are the files.
"""
from __future__ import annotations

import argparse
import hashlib
import io
import json
import os
import re
import signal
import sys
import threading
import time
import uuid
import warnings
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from multiprocessing import get_context, parent_process
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, TextIO, Tuple

import numpy as np

from . import _dynpoint
from ._files import PART, locked, whole
from ._device import Device, Scene
from ._mesh import Mesh, PathLike
from ._structs import DEVICE_STATE
from ._world import World

OK, LOST = "DPT_OK", "LOST"
# Of the machine, not of the job: the next call tries again.
PASSING = (LOST, "DPT_E_SYSTEM", "DPT_E_MEMORY", "MemoryError")
HEADER = "in\tout\tverdict\tsha256\tseconds\tnote\n"
CELLS = {"compile": 2, "query": 3, "sweep": 4}
# Deaths of workers that one job may be near to, before it is run with nobody beside it; and then of its own.
DEATHS = 2
# More processes than this a pool of Windows cannot wait for.
POOL_MAX = 61 if os.name == "nt" else 1 << 16


class Job(NamedTuple):
    """What a worker gets."""

    kind: str
    cells: Tuple[str, ...]
    settings: Mapping[str, Any]

    @property
    def out(self) -> str:
        return self.cells[1]

    @property
    def source(self) -> str:
        return self.cells[0] if len(self.cells) == 2 else " ".join((self.cells[0], *self.cells[2:]))


class Row(NamedTuple):
    """What is known of a job that is done."""

    source: str
    out: str
    verdict: str
    hash: str
    seconds: float
    note: str

    def text(self) -> str:
        return "\t".join((*self[:4], f"{self.seconds:.6f}", self.note)) + "\n"


class Summary(NamedTuple):
    """How a call ended. `kept` were there before; `lost` is how often a worker died."""

    done: int
    refused: int
    kept: int
    lost: int
    rows: List[Row]


# ---- What workers do

def _compile(job: Job) -> bytes:
    return bytes(Mesh.load(job.cells[0], **job.settings))


def _to_npy(array: Any) -> bytes:
    content = io.BytesIO()
    np.save(content, array, allow_pickle=False)
    return content.getvalue()


def _query(job: Job) -> bytes:
    mesh = Mesh.load(job.cells[0])
    ends = np.ascontiguousarray(np.load(job.cells[2], allow_pickle=False), np.float64)
    return _to_npy(mesh.query(ends, **job.settings).view(np.ndarray))


def _sweep_mesh(job: Job, poses: Any, settings: Dict[str, Any]) -> Any:
    wrenches = np.zeros((len(poses), 6))
    with World(**settings.get("world", {})) as world:
        world.add_body(Mesh.load(job.cells[0]), **settings.get("body", {}))
        tool = world.add_tool((0, 0, 0), (0, 0, settings.get("length", 0.0)), settings.get("radius", 0.001),
                              **settings.get("tool", {}))
        for pose, wrench in zip(poses, wrenches):
            tool.tick(pose, settings.get("dt", 0.001), wrench)
    return wrenches


def _sweep_scene(job: Job, poses: Any, settings: Dict[str, Any]) -> Any:
    wrenches = np.zeros((len(poses), 6))
    period = int(1e9 * settings.pop("dt", 0.001))
    with Device("sim:") as device:
        info = device.info
    with Scene(job.cells[0], info=info, **settings) as scene:
        for i, pose in enumerate(poses):
            state = np.zeros(1, DEVICE_STATE)
            state["pose"], state["time_ns"], state["sequence"] = pose, (i + 1) * period, i + 1
            state["fresh"], state["status"] = 1, 3
            wrenches[i] = scene.tick(state, (i + 1) * period)
    return wrenches


def _sweep(job: Job) -> bytes:
    poses = np.ascontiguousarray(np.load(job.cells[2], allow_pickle=False), np.float64)
    if poses.ndim != 2 or poses.shape[1] != 7:
        raise ValueError(f"{job.cells[2]}: wanted poses of shape (n, 7), not {poses.shape}")
    settings = {**job.settings, **json.loads(job.cells[3])}
    felt = _sweep_mesh if job.cells[0].endswith(".dpa") else _sweep_scene
    return _to_npy(felt(job, poses, settings))


_CALLS = {"compile": _compile, "query": _query, "sweep": _sweep}


def _put(path: str, content: bytes) -> None:
    """A file of that name is whole, whoever dies, and whoever else writes it."""
    with whole(path) as part:
        part.write_bytes(content)


def _line(text: object) -> str:
    return " ".join(str(text).split())[:250]


def do(job: Job) -> Row:
    """One job, in a worker."""
    began = time.perf_counter()
    verdict, digest, note = OK, "", ""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            content = _CALLS[job.kind](job)
            _put(job.out, content)
            digest = hashlib.sha256(content).hexdigest()
        except _dynpoint.Error as error:
            verdict, note = error.name, _line(error)
        except OSError as error:
            verdict, note = "DPT_E_SYSTEM", _line(error)
        except Exception as error:  # whatever a reader makes of a damaged file: the other jobs go on
            verdict, note = type(error).__name__, _line(error)
    if not note and said:
        note = _line(said[0].message)
    return Row(job.source, job.out, verdict, digest, time.perf_counter() - began, note)


# ---- Who works

def _end_with_parent() -> None:
    """A worker whose parent was killed would wait for it for ever. Ctrl-C ends it as well: what it was at is done
    again."""
    parent = parent_process()
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, lambda *_: os._exit(1))

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class _Pool:
    """Spawned processes of this machine. One that dies breaks the pool: those jobs that may have killed it are run once
    more, each alone in the end."""

    def __init__(self, workers: int) -> None:
        self.workers, self.lost = min(workers, POOL_MAX), 0

    def run(self, jobs: Sequence[Job]) -> Iterator[Row]:
        waiting: List[Job] = list(reversed(jobs))
        suspects: List[Job] = []
        deaths: Dict[str, int] = {}
        while waiting or suspects:
            alone = not waiting
            some, workers = (suspects, 1) if alone else (waiting, self.workers)
            yield from self._run_some(some, workers, suspects, deaths, alone)

    def _run_some(self, waiting: List[Job], workers: int, suspects: List[Job], deaths: Dict[str, int],
                  alone: bool) -> Iterator[Row]:
        running: Dict[Future[Row], Job] = {}
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_end_with_parent) as pool:
            while waiting or running:
                try:
                    while waiting and len(running) < workers:
                        running[pool.submit(do, waiting[-1])] = waiting[-1]
                        waiting.pop()
                    done, _ = wait(running, return_when=FIRST_COMPLETED)
                    for future in done:
                        row = future.result()
                        del running[future]
                        yield row
                except BrokenProcessPool:
                    self.lost += 1
                    for future, job in running.items():
                        if future.done() and not future.cancelled() and future.exception() is None:
                            yield future.result()
                            continue
                        deaths[job.out] = deaths.get(job.out, 0) + 1
                        if alone and deaths[job.out] > DEATHS:
                            yield Row(job.source, job.out, LOST, "", 0.0, "the worker died each time")
                        elif alone or deaths[job.out] >= DEATHS:
                            suspects.append(job)
                        else:
                            waiting.append(job)
                    return


def _error_of(future: Any) -> Optional[BaseException]:
    """Why a job of Dask's has no row. The exception of one that was cancelled is raised, not returned."""
    try:
        error: Optional[BaseException] = future.exception()
        return error
    except Exception as cancelled:
        return cancelled


class _Cluster:
    """A client of Dask's `distributed`, whose workers see the same files. It runs again what a dead worker had."""

    def __init__(self, client: Any) -> None:
        self.client, self.lost = client, 0

    def run(self, jobs: Sequence[Job]) -> Iterator[Row]:
        distributed = import_module("distributed")
        waiting = list(reversed(jobs))
        running: Dict[str, Job] = {}
        tries: Dict[str, int] = {}
        room = max(4, 4 * sum(self.client.nthreads().values()))
        queue = distributed.as_completed()
        while waiting or running:
            while waiting and len(running) < room:
                job = waiting.pop()
                future = self.client.submit(do, job, key=f"dynpoint-{uuid.uuid4()}", pure=False)
                running[future.key] = job
                queue.add(future)
            future = next(queue)
            job = running.pop(future.key)
            error = _error_of(future)
            if error is None:
                yield future.result()
                continue
            # What a job does wrong is in its row: this is of the machines, as a connection that was lost.
            self.lost += 1
            killed = type(error).__name__ == "KilledWorker"  # Dask has tried again already
            tries[job.out] = tries.get(job.out, 0) + 1
            if not killed and tries[job.out] < DEATHS and self.client.status == "running":
                waiting.append(job)
            else:
                note = "the worker died each time" if killed else _line(f"{type(error).__name__}: {error}")
                yield Row(job.source, job.out, LOST, "", 0.0, note)


# ---- The manifest and the table

def _read_lines(path: PathLike) -> List[str]:
    """As the program reads them: names may have any bytes but tabs and ends of lines, which alone end a line."""
    return Path(path).read_bytes().decode("utf-8", "surrogateescape").split("\n")


class _Places:
    """Which names are one file's."""

    def __init__(self) -> None:
        self.folders: Dict[str, str] = {}

    def of(self, path: str) -> str:
        if os.path.islink(path):
            return os.path.realpath(path)
        folder, name = os.path.split(path)
        if folder not in self.folders:
            self.folders[folder] = os.path.realpath(folder)
        return os.path.normcase(os.path.join(self.folders[folder], name))


def read_manifest(kind: str, manifest: PathLike, settings: Mapping[str, Any]) -> List[Job]:
    """Its jobs; ValueError with the line that is wrong."""
    jobs, ending, places = [], ".dpa" if kind == "compile" else ".npy", _Places()
    outs: Dict[str, int] = {}
    read: Dict[str, int] = {}
    for number, line in enumerate(_read_lines(manifest), 1):
        line = line.removesuffix("\r")
        if not line or line.startswith("#"):
            continue
        cells = tuple(line.split("\t"))
        if len(cells) != CELLS[kind] or not all(cells):
            raise ValueError(f"{manifest}:{number}: a line of {kind} has {CELLS[kind]} cells, with tabs between")
        out = places.of(cells[1])
        if out in outs:
            raise ValueError(f"{manifest}:{number}: '{cells[1]}' is to be written twice, as in line {outs[out]}")
        if not cells[1].endswith(ending):
            raise ValueError(f"{manifest}:{number}: '{cells[1]}' does not end in {ending}")
        outs[out] = number
        read.update((places.of(cell), number) for cell in (cells[0], *cells[2:3]))
        jobs.append(Job(kind, cells, settings))
    for out, number in outs.items():
        if out in read:
            raise ValueError(f"{manifest}:{number}: what it writes is read, too, in line {read[out]}")
    if not jobs:
        raise ValueError(f"{manifest}: it lists nothing")
    return jobs


def _first_line(kind: str, settings: Mapping[str, Any]) -> str:
    said = json.dumps(dict(settings), sort_keys=True,
                      default=lambda value: value.tolist() if isinstance(value, np.ndarray) else str(value))
    return f"# dynpoint {_dynpoint.version}, {kind} {hashlib.sha256(said.encode()).hexdigest()[:16]}\n"


def _is_there(row: Row) -> bool:
    try:
        return hashlib.sha256(Path(row.out).read_bytes()).hexdigest() == row.hash
    except OSError:
        return False


def read_table(path: PathLike) -> List[Row]:
    """The rows of a table of results; a last one that was cut is left out."""
    rows = []
    for line in _read_lines(path)[1:-1]:
        cells = line.split("\t")
        if len(cells) == 6 and re.fullmatch(r"[0-9]+\.[0-9]{6}", cells[4]):
            rows.append(Row(cells[0], cells[1], cells[2], cells[3], float(cells[4]), cells[5]))
    return rows


def _write_table(path: PathLike, first: str, jobs: Sequence[Job], rows: Mapping[str, Row]) -> None:
    text = first + HEADER + "".join(rows[job.out].text() for job in jobs if job.out in rows)
    _put(os.fspath(path), text.encode("utf-8", "surrogateescape"))


def run(kind: str, manifest: PathLike, results: PathLike, *, workers: Optional[int] = None, client: Any = None,
        **settings: Any) -> Summary:
    """Do what a manifest lists.

    workers   spawned processes of this machine; None: as many as there are processors
    client    a distributed.Client instead: its workers must see the same files by the same names, and have this package
    settings  of every job: those of Mesh.load, of Mesh.query, or of each sweep

    Rows are added as jobs end, in any order, and sorted as the manifest is in the end. LOST is the verdict of a job whose
    worker died each time."""
    with locked(manifest):
        return _run(kind, read_manifest(kind, manifest, settings), results, workers, client, settings)


def _run(kind: str, jobs: List[Job], results: PathLike, workers: Optional[int], client: Any,
         settings: Mapping[str, Any]) -> Summary:
    first, by_out = _first_line(kind, settings), {job.out: job for job in jobs}
    rows: Dict[str, Row] = {}
    if Path(results).exists() and Path(results).stat().st_size:
        if _read_lines(results)[0] + "\n" != first:
            raise ValueError(f"{results}: it is no table of these settings and this version: name another one")
        for row in read_table(results):
            job = by_out.get(row.out)
            if job and row.source == job.source and row.verdict not in PASSING and (row.verdict != OK or _is_there(row)):
                rows[row.out] = row
    kept = len(rows)
    _write_table(results, first, jobs, rows)
    crew: Any = _Cluster(client) if client is not None else _Pool(workers or os.cpu_count() or 1)
    with open(results, "a", encoding="utf-8", errors="surrogateescape", newline="\n") as table:
        for row in crew.run([job for job in jobs if job.out not in rows]):
            if row.out not in rows:
                rows[row.out] = row
                _add(table, row)
    _write_table(results, first, jobs, rows)
    _sweep_up(jobs)
    ordered = [rows[job.out] for job in jobs]
    refused = sum(row.verdict != OK for row in ordered)
    return Summary(len(ordered) - refused, refused, kept, crew.lost, ordered)


def _sweep_up(jobs: Sequence[Job]) -> None:
    """What workers that died left behind."""
    names: Dict[Path, set[str]] = {}
    for job in jobs:
        names.setdefault(Path(job.out).parent, set()).add(Path(job.out).name)
    for folder, wanted in names.items():
        for path in folder.glob("*.part") if folder.is_dir() else ():
            if PART.sub("", path.name) in wanted:
                path.unlink(missing_ok=True)


def _add(table: TextIO, row: Row) -> None:
    table.write(row.text())
    table.flush()


def _read_word(word: str) -> Any:
    try:
        return json.loads(word)
    except ValueError:
        return word


def main() -> None:
    parser = argparse.ArgumentParser(prog="python3 -m dynpoint.bulk", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=sorted(CELLS))
    parser.add_argument("manifest")
    parser.add_argument("results")
    parser.add_argument("--unit", help="of sources that are compiled")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="another setting; VALUE in JSON")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--scheduler", help="the address of Dask's, in place of processes of this machine")
    given = parser.parse_args()
    settings = {name: _read_word(word) for name, _, word in (item.partition("=") for item in given.set)}
    if given.unit:
        settings["unit"] = given.unit
    client: Any = None
    try:
        if given.scheduler:
            client = import_module("distributed").Client(given.scheduler)
        summary = run(given.kind, given.manifest, given.results, workers=given.workers, client=client, **settings)
    except (ImportError, OSError, ValueError) as error:
        sys.exit(f"dynpoint.bulk: {error}")
    except KeyboardInterrupt:
        print("dynpoint.bulk: stopped; called again, it goes on", file=sys.stderr)
        sys.exit(130)
    finally:
        if client is not None:
            client.close()
    print(f"{given.results}: {summary.done} done, {summary.refused} refused; {summary.kept} of these were there")
    sys.exit(summary.refused > 0)


if __name__ == "__main__":
    main()
