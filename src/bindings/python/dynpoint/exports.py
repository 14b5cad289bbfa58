# SPDX-License-Identifier: BSD-3-Clause
"""Recordings (.dpr) as NumPy's arrays, HDF5, MCAP and LeRobotDataset v3, and back again, bit for bit: a replay of what
comes back gives the same forces. docs/exports.md is the contract: what is sampled when, in which units and frames.

    python3 -m dynpoint.exports run.dpr run.h5         # or run.mcap, or a folder for LeRobot
    python3 -m dynpoint.exports run.h5 again.dpr       # from each of them
    dynpoint replay again.dpr
"""
from __future__ import annotations

import errno
import json
import os
import struct
import sys
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _dynpoint
from ._files import whole
from ._mesh import PathLike
from ._recording import read_ticks
from ._structs import RECORD, Records

CONTRACT = 1

_AT, _HOST = "at time_ns", "the host's answer to the sample"
# Unit, frame and when, of each field of RECORD but its size.
FIELDS: Dict[str, Tuple[str, str, str]] = {
    "device": ("", "", "number of the device and its tool"),
    "number": ("", "", "running number of ticks; a gap: records that were dropped"),
    "sequence": ("", "", "the device's own number of the sample"),
    "time_ns": ("ns", "the device's clock", "when the sample was taken"),
    "sent_ns": ("ns", "the device's clock", "when the device took `sent`; 0: it took none"),
    "late_ns": ("ns", "", "from the tick's deadline to the tick"),
    "took_ns": ("ns", "", "how long the step took"),
    "dt": ("s", "", "length of the step"),
    "flags": ("bits", "", "1: the tool was moved to this sample; 2: a body was held"),
    "result": ("dpt_result", "", "of the tick"),
    "status": ("DPT_DEVICE_STATUS_", "", _AT),
    "reasons": ("DPT_REASON_ bits", "", _AT),
    "code": ("", "", "the device's own fault code, " + _AT),
    "buttons": ("bits", "", _AT),
    "fresh": ("0 or 1", "", "1: the sample is a new one"),
    "commands": ("", "", "commands that the device took since the last record that was felt"),
    "force_reason": ("DPT_FORCE_", "", _HOST),
    "force_flags": ("DPT_FORCE_FLAG_ bits", "", _HOST),
    "hit_status": ("DPT_STATUS_", "", _HOST),
    "contact": ("DPT_CONTACT_", "", _HOST),
    "hit_flags": ("DPT_HIT_FLAG_ bits", "", _HOST),
    "triangle": ("", "the source's numbers", _HOST),
    "pose": ("m; quaternion w, x, y, z", "device", _AT),
    "velocity": ("m/s", "device", _AT),
    "spin": ("rad/s", "device", _AT),
    "joint": ("rad or m", "device", _AT),
    "asked": ("N, Nm", "device", _HOST + ", before the guard"),
    "sent": ("N, Nm", "device", "what acted since the sample before, after the guard"),
    "proxy": ("m; quaternion w, x, y, z", "world", _HOST),
    "distance": ("m", "world", _HOST),
    "gap": ("m", "world", _HOST + "; valid if hit_flags has bit 0"),
    "energy": ("J", "", "energy that the law stores: " + _HOST),
    "lag": ("m", "world", "how far the proxy still is from its rest: " + _HOST),
    "point": ("m", "world", "the nearest point of the mesh: " + _HOST),
    "depth": ("m", "", "depth of a needle's tip below the entry of its first channel: " + _HOST),
    "inside": ("m", "", "length of the needle's shaft inside all bodies: " + _HOST),
    "ruptures": ("", "", "number of pierced walls in its channels: " + _HOST),
    "layers": ("", "", "number of layers that its tip has entered: " + _HOST),
}


class Take(NamedTuple):
    """A recording. `records` are structs of RECORD; `header` and `pieces` are the file's own bytes, before and behind the
    ticks: the scene's text, and files that the recording carries."""

    header: bytes
    records: Records
    pieces: bytes

    @property
    def text(self) -> str:
        return _dynpoint.read_header(self.header)[0]

    @property
    def rate(self) -> float:
        return _dynpoint.read_header(self.header)[1]

    @property
    def began_ns(self) -> int:
        return _dynpoint.read_header(self.header)[2]

    def arrays(self) -> Dict[str, npt.NDArray[Any]]:
        """Each field of FIELDS as an array of n rows, with its own type."""
        return {name: np.ascontiguousarray(self.records[name]) for name in FIELDS}

    def save(self, path: PathLike) -> None:
        """The .dpr file."""
        with whole(path) as part:
            part.write_bytes(self.header + _dynpoint.write_records(self.records) + self.pieces)


def from_arrays(header: bytes, arrays: Dict[str, npt.NDArray[Any]], pieces: bytes = b"") -> Take:
    """A recording of what `arrays` told."""
    records: Records = np.zeros(len(arrays["number"]), RECORD)
    for name in FIELDS:
        records[name] = arrays[name]
    return Take(header, records, pieces)


def load(path: PathLike) -> Take:
    """A .dpr file. One that is cut or damaged is read up to there, with a warning."""
    content = Path(path).read_bytes()
    start = _dynpoint.read_header(content)[4]
    records, at, fault = read_ticks(content, start)
    if fault:
        warnings.warn(f"{os.fspath(path)}: byte {at}: {fault}; what is before it is read", stacklevel=2)
    pieces, place = [], start
    while place + 24 <= at:
        kind, length = struct.unpack_from("<II", content, place)
        if kind != 1:
            pieces.append(content[place:place + length])
        place += length
    records["size"] = 0
    return Take(content[:start], records, b"".join(pieces))


# ---- HDF5

def to_hdf5(take: Take, path: PathLike) -> None:
    """/ticks/FIELD, (n, ...), with attributes unit, frame and when; /header and /pieces, bytes; what the header tells is
    in attributes of the file."""
    h5py = import_module("h5py")
    with whole(path) as part, h5py.File(part, "w") as file:
        file.attrs.update(format="dynpoint recording", contract=CONTRACT, text=take.text, rate=take.rate,
                          began_ns=np.uint64(take.began_ns))
        ticks = file.create_group("ticks")
        for name, array in take.arrays().items():
            data = ticks.create_dataset(name, data=array)
            data.attrs["unit"], data.attrs["frame"], data.attrs["when"] = FIELDS[name]
        for name, content in (("header", take.header), ("pieces", take.pieces)):
            file.create_dataset(name, data=np.frombuffer(content, np.uint8))


def from_hdf5(path: PathLike) -> Take:
    h5py = import_module("h5py")
    with h5py.File(path, "r") as file:
        return from_arrays(bytes(file["header"][()]), {name: file["ticks"][name][()] for name in FIELDS},
                           bytes(file["pieces"][()]))


# ---- MCAP: ROS 2's messages, whose fields lie as in the struct

TOPIC, TYPE = "/dynpoint/tick", "dynpoint_msgs/msg/Tick"
_ROS = {"u4": "uint32", "i4": "int32", "u8": "uint64", "f8": "float64"}
_CDR = b"\x00\x01\x00\x00"  # little-endian


def _ros_definition() -> str:
    lines = ["# A tick of a recording of dynpoint's: dpt_record, in its order."]
    for name in RECORD.names or ():
        kind = RECORD[name]
        count = f"[{kind.shape[0]}]" if kind.shape else ""
        what = "; ".join(part for part in FIELDS.get(name, ()) if part)
        lines.append(f"{_ROS[kind.base.str[1:]]}{count} {name}{'  # ' + what if what else ''}")
    return "\n".join(lines) + "\n"


def to_mcap(take: Take, path: PathLike) -> None:
    """Messages of TYPE on TOPIC; their log time is time_ns, on the device's clock. The header's text is metadata
    `dynpoint`; header and pieces are attachments."""
    writer_module = import_module("mcap.writer")
    with whole(path) as part, open(part, "wb") as file:
        writer = writer_module.Writer(file)
        writer.start(profile="ros2", library=f"dynpoint {_dynpoint.version}")
        schema = writer.register_schema(name=TYPE, encoding="ros2msg", data=_ros_definition().encode())
        channel = writer.register_channel(topic=TOPIC, message_encoding="cdr", schema_id=schema)
        for i, record in enumerate(take.records):
            time = int(record["time_ns"])
            writer.add_message(channel_id=channel, log_time=time, publish_time=time, sequence=i & 0xFFFFFFFF,
                               data=_CDR + record.tobytes())
        writer.add_metadata("dynpoint", {"text": take.text, "rate": repr(take.rate), "began_ns": str(take.began_ns),
                                         "contract": str(CONTRACT)})
        for name, content in (("header", take.header), ("pieces", take.pieces)):
            writer.add_attachment(create_time=take.began_ns, log_time=take.began_ns, name=name,
                                  media_type="application/octet-stream", data=content)
        writer.finish()


def from_mcap(path: PathLike) -> Take:
    reader_module = import_module("mcap.reader")
    with open(path, "rb") as file:
        reader = reader_module.make_reader(file)
        parts = {part.name: bytes(part.data) for part in reader.iter_attachments()}
        rows = [message.data[len(_CDR):] for _, _, message in
                reader.iter_messages(topics=[TOPIC], log_time_order=False)]
    records: Records = np.frombuffer(b"".join(rows), RECORD).copy()
    return Take(parts["header"], records, parts["pieces"])


# ---- LeRobotDataset v3

_STATE = ("pose", "velocity", "spin", "asked")
_NAMES = {3: ["x", "y", "z"], 6: ["fx", "fy", "fz", "tx", "ty", "tz"], 7: ["x", "y", "z", "qw", "qx", "qy", "qz"]}
_VERSION, _CHUNK = "v3.0", 1000
_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


def _columns(take: Take) -> Dict[str, npt.NDArray[Any]]:
    """Those that learning reads, in float32, and all fields as they are."""
    arrays = take.arrays()
    columns = {"observation.state": np.concatenate([arrays[name] for name in _STATE], axis=1).astype(np.float32),
               "action": np.concatenate((arrays["proxy"], arrays["sent"]), axis=1).astype(np.float32)}
    columns.update((f"dynpoint.{name}", array) for name, array in arrays.items())
    return columns


def _feature(name: str, array: npt.NDArray[Any]) -> Dict[str, Any]:
    names: Any = None
    if name == "observation.state":
        names = [f"{part}_{axis}" for part, size in zip(_STATE, (7, 3, 3, 6)) for axis in _NAMES[size]]
    elif name == "action":
        names = [f"{part}_{axis}" for part, size in (("proxy", 7), ("sent", 6)) for axis in _NAMES[size]]
    return {"dtype": str(array.dtype), "shape": list(array.shape[1:]) or [1], "names": names}


def _statistics(array: npt.NDArray[Any]) -> Dict[str, List[float]]:
    rows = array.reshape(len(array), -1).astype(np.float64)
    return {"min": rows.min(0).tolist(), "max": rows.max(0).tolist(), "mean": rows.mean(0).tolist(),
            "std": rows.std(0).tolist(), "count": [len(rows)]}


def to_lerobot(takes: Sequence[Take], folder: PathLike, *, task: str = "touch", robot: str = "dynpoint") -> None:
    """A data set of the recordings, an episode each; `folder` must not be there. The rate of all must be one, a whole
    number. `timestamp` is frame_index / fps, as LeRobot wants it; when a sample was taken is dynpoint.time_ns."""
    rates = {take.rate for take in takes}
    if len(rates) != 1 or not all(rate > 0 and rate == int(rate) for rate in rates):
        raise ValueError(f"the rates are {sorted(rates)} Hz: wanted one, a whole number")
    if not all(len(take.records) for take in takes):
        raise ValueError("a recording has no ticks")
    if Path(folder).exists():
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), os.fspath(folder))
    Path(folder).parent.mkdir(parents=True, exist_ok=True)
    with whole(folder) as part:
        part.mkdir()
        _write_set(takes, part, int(rates.pop()), task, robot)


def _write_set(takes: Sequence[Take], root: Path, fps: int, task: str, robot: str) -> None:
    pa, pq = import_module("pyarrow"), import_module("pyarrow.parquet")
    begin, columns = 0, [_columns(take) for take in takes]
    tables, episodes = [], []
    for number, each in enumerate(columns):
        count = len(takes[number].records)
        frame = np.arange(count)
        index: Dict[str, npt.NDArray[Any]] = {
            "timestamp": (frame / fps).astype(np.float32), "frame_index": frame, "episode_index": np.full(count, number),
            "index": begin + frame, "task_index": np.zeros(count, np.int64)}
        tables.append(pa.table({name: _arrow(pa, array) for name, array in {**each, **index}.items()}))
        row: Dict[str, Any] = {
            "episode_index": number, "tasks": [task], "length": count, "data/chunk_index": number // _CHUNK,
            "data/file_index": number % _CHUNK, "dataset_from_index": begin, "dataset_to_index": begin + count,
            "meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
        row.update((f"stats/{name}/{what}", value) for name, array in {**each, **index}.items()
                   for what, value in _statistics(array).items())
        episodes.append(row)
        begin += count
    for number, table in enumerate(tables):
        place = root / _DATA.format(chunk_index=number // _CHUNK, file_index=number % _CHUNK)
        place.parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(table, place)
    (root / "meta/episodes/chunk-000").mkdir(parents=True)
    pq.write_table(pa.Table.from_pylist(episodes), root / "meta/episodes/chunk-000/file-000.parquet")
    tasks = pa.table({"task_index": pa.array([0], pa.int64()), "__index_level_0__": [task]})
    kinds = (("task_index", "task_index", "int64", "int64"), (None, "__index_level_0__", "unicode", "object"))
    about = {"index_columns": ["__index_level_0__"], "column_indexes": [], "columns": [
        {"name": name, "field_name": field, "pandas_type": kind, "numpy_type": base, "metadata": None}
        for name, field, kind, base in kinds]}
    pq.write_table(tasks.replace_schema_metadata({"pandas": json.dumps(about)}), root / "meta/tasks.parquet")
    whole = {name: np.concatenate([each[name] for each in columns]) for name in columns[0]}
    features = {name: _feature(name, array) for name, array in whole.items()}
    features.update((name, {"dtype": kind, "shape": [1], "names": None}) for name, kind in (
        ("timestamp", "float32"), ("frame_index", "int64"), ("episode_index", "int64"), ("index", "int64"),
        ("task_index", "int64")))
    _write_json(root / "meta/info.json", {
        "codebase_version": _VERSION, "robot_type": robot, "total_episodes": len(takes), "total_frames": begin,
        "total_tasks": 1, "chunks_size": _CHUNK, "data_files_size_in_mb": 100, "video_files_size_in_mb": 200, "fps": fps,
        "splits": {"train": f"0:{len(takes)}"}, "data_path": _DATA, "video_path": None, "features": features})
    _write_json(root / "meta/stats.json", {name: _statistics(array) for name, array in whole.items()})
    fields = {name: dict(zip(("unit", "frame", "when"), what)) for name, what in FIELDS.items()}
    _write_json(root / "meta/dynpoint.json", {
        "contract": CONTRACT, "fields": fields,
        "episodes": [{"text": take.text, "header": take.header.hex(), "pieces": take.pieces.hex()} for take in takes]})


def _arrow(pa: Any, array: npt.NDArray[Any]) -> Any:
    if array.ndim == 1:
        return pa.array(array)
    return pa.FixedSizeListArray.from_arrays(pa.array(array.ravel()), array.shape[1])


def _write_json(path: Path, what: Any) -> None:
    path.write_text(json.dumps(what, indent=1), encoding="utf-8")


def from_lerobot(folder: PathLike, episode: int = 0) -> Take:
    """One episode of a data set that to_lerobot wrote."""
    pq = import_module("pyarrow.parquet")
    root = Path(folder)
    info = json.loads((root / "meta/info.json").read_text(encoding="utf-8"))
    kept = json.loads((root / "meta/dynpoint.json").read_text(encoding="utf-8"))["episodes"][episode]
    row = pq.read_table(root / "meta/episodes/chunk-000/file-000.parquet").slice(episode, 1).to_pylist()[0]
    place = info["data_path"].format(chunk_index=row["data/chunk_index"], file_index=row["data/file_index"])
    table = pq.read_table(root / place)
    arrays = {}
    for name in FIELDS:
        column = table.column(f"dynpoint.{name}").combine_chunks()
        kind = RECORD[name]
        flat = column.flatten() if kind.shape else column
        arrays[name] = flat.to_numpy(zero_copy_only=False).reshape(-1, *kind.shape)
    return from_arrays(bytes.fromhex(kept["header"]), arrays, bytes.fromhex(kept["pieces"]))


# ---- By a path's ending

def read(path: PathLike) -> Take:
    """A recording from whichever form the path's ending says; a folder is LeRobot's, its first episode."""
    ending = Path(path).suffix
    if Path(path).is_dir():
        return from_lerobot(path)
    return {".h5": from_hdf5, ".hdf5": from_hdf5, ".mcap": from_mcap}.get(ending, load)(path)


def write(take: Take, path: PathLike) -> None:
    """The form that the path's ending says; without one it is a folder of LeRobot's."""
    ending = Path(path).suffix
    if ending == "":
        to_lerobot([take], path)
    elif ending == ".dpr":
        take.save(path)
    elif ending in (".h5", ".hdf5", ".mcap"):
        (to_mcap if ending == ".mcap" else to_hdf5)(take, path)
    else:
        raise ValueError(f"{os.fspath(path)}: wanted .dpr, .h5, .hdf5, .mcap, or a folder's name")


def main() -> None:
    if len(sys.argv) != 3 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    try:
        write(read(sys.argv[1]), sys.argv[2])
    except (OSError, ValueError, KeyError, ImportError, _dynpoint.Error) as error:
        sys.exit(f"dynpoint.exports: {error}")


if __name__ == "__main__":
    main()
