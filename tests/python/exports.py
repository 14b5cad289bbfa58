# SPDX-License-Identifier: BSD-3-Clause
"""dynpoint.exports: a recording that went to HDF5, MCAP or LeRobot's columns and came back has its old bytes, and a
replay of it finds the same forces; h5py, mcap with ROS 2's decoder, and pyarrow read what was written without this
package."""
import importlib.util
import json
import resource
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import dynpoint as dp
import dynpoint.exports as exports
from verdicts import PROGRAM, main, program

TICKS = 1500


def need(*modules):
    for module in modules:
        if importlib.util.find_spec(module) is None:
            raise unittest.SkipTest(f"no {module}")


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.room = room = Path(cls.folder.name)
        program("make", "liver", 2000, "-o", room / "liver.obj")
        program("compile", room / "liver.obj", "-o", room / "liver.dpa")
        cls.paths = [room / "plain.dpr", room / "carried.dpr"]
        for path, more in zip(cls.paths, ([], ["--embed", "--friction", "0.3"])):
            program("run", room / "liver.dpa", "--device", "sim:?hand=press", "--ticks", TICKS, "--record", path, *more)
        cls.takes = [exports.load(path) for path in cls.paths]
        cls.told = [dp.Recording(path).records for path in cls.paths]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def judge(self, back, i):
        """What came back is the recording, and it is felt as before."""
        path = self.room / "back.dpr"
        back.save(path)
        self.assertEqual(path.read_bytes(), self.paths[i].read_bytes())
        self.assertIn(f"{TICKS} ticks, all the same bits", program("replay", path))

    def test_arrays_have_each_field_and_come_back(self):
        self.assertEqual(["size", *exports.FIELDS], list(dp.RECORD.names))
        for i, take in enumerate(self.takes):
            arrays = take.arrays()
            for name, array in arrays.items():
                self.assertEqual(array.tobytes(), np.ascontiguousarray(self.told[i][name]).tobytes(), name)
            self.assertGreater(np.abs(arrays["asked"]).max(), 0.1)
            self.judge(exports.from_arrays(take.header, arrays, take.pieces), i)
        self.assertEqual((len(self.takes[0].pieces) > 0, len(self.takes[1].pieces) > 10000), (False, True))

    def test_hdf5(self):
        need("h5py")
        import h5py
        for i, take in enumerate(self.takes):
            path = self.room / f"{i}.h5"
            exports.write(take, path)
            with h5py.File(path) as file:
                self.assertEqual(file.attrs["rate"], 1000)
                self.assertIn("scene=", file.attrs["text"])
                for name, what in exports.FIELDS.items():
                    data = file["ticks"][name]
                    self.assertEqual((data.dtype, data.shape), (dp.RECORD[name].base, (TICKS, *dp.RECORD[name].shape)))
                    self.assertEqual(data[()].tobytes(), np.ascontiguousarray(self.told[i][name]).tobytes())
                    self.assertEqual((data.attrs["unit"], data.attrs["frame"], data.attrs["when"]), what)
            self.judge(exports.read(path), i)

    def test_mcap(self):
        need("mcap", "mcap_ros2")
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory
        for i, take in enumerate(self.takes):
            path = self.room / f"{i}.mcap"
            exports.write(take, path)
            with open(path, "rb") as file:
                reader = make_reader(file, decoder_factories=[DecoderFactory()])
                found = list(reader.iter_decoded_messages(topics=["/dynpoint/tick"]))
                self.assertEqual((len(found), {schema.name for schema, *_ in found}), (TICKS, {"dynpoint_msgs/msg/Tick"}))
                for k in range(0, TICKS, 50):
                    _, _, message, tick = found[k]
                    self.assertEqual(message.log_time, self.told[i]["time_ns"][k])
                    for name in exports.FIELDS:
                        self.assertTrue(np.array_equal(getattr(tick, name), self.told[i][name][k], equal_nan=True), name)
                metadata = [part for part in reader.iter_metadata() if part.name == "dynpoint"]
                self.assertEqual((metadata[0].metadata["text"], float(metadata[0].metadata["rate"])), (take.text, 1000))
            self.judge(exports.read(path), i)

    def test_lerobot_s_columns(self):
        need("pyarrow")
        import pyarrow.parquet as pq
        root = self.room / "set"
        exports.to_lerobot(self.takes, root, task="press the liver")
        info = json.loads((root / "meta/info.json").read_text(encoding="utf-8"))
        self.assertEqual((info["codebase_version"], info["total_episodes"], info["total_frames"], info["fps"]),
                         ("v3.0", 2, 2 * TICKS, 1000))
        episodes = pq.read_table(root / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
        tasks = pq.read_table(root / "meta/tasks.parquet").to_pydict()
        self.assertEqual(tasks, {"task_index": [0], "__index_level_0__": ["press the liver"]})
        begin = 0
        for i, row in enumerate(episodes):
            self.assertEqual((row["dataset_from_index"], row["dataset_to_index"], row["length"], row["tasks"]),
                             (begin, begin + TICKS, TICKS, ["press the liver"]))
            begin += TICKS
            place = info["data_path"].format(chunk_index=row["data/chunk_index"], file_index=row["data/file_index"])
            table = pq.read_table(root / place)
            self.assertEqual(set(table.column_names), set(info["features"]))
            for name, feature in info["features"].items():
                kind = table.schema.field(name).type
                shape = [kind.list_size] if hasattr(kind, "list_size") else [1]
                base = kind.value_type if hasattr(kind, "value_type") else kind
                self.assertEqual(({"double": "float64", "float": "float32"}.get(str(base), str(base)), shape),
                                 (feature["dtype"], feature["shape"]), name)
                self.assertTrue(feature["names"] is None or len(feature["names"]) == shape[0])
            self.assertTrue(np.array_equal(table["index"].to_numpy(), i * TICKS + np.arange(TICKS)))
            self.assertTrue(np.allclose(table["timestamp"].to_numpy(), np.arange(TICKS) / 1000))
            action = np.stack(table["action"].to_numpy(zero_copy_only=False))
            self.assertTrue(np.array_equal(action[:, 7:], self.told[i]["sent"].astype(np.float32)))
            self.assertTrue(np.allclose(row["stats/action/max"], action.max(0)))
            self.judge(exports.from_lerobot(root, i), i)
        with self.assertRaises(FileExistsError):
            exports.to_lerobot(self.takes, root)

    def test_as_a_command_each_into_each(self):
        need("h5py", "mcap", "pyarrow")
        chain = [self.paths[1], *(self.room / name for name in ("a.h5", "b.mcap", "c", "d.dpr"))]
        for path, to in zip(chain, chain[1:]):
            subprocess.run([sys.executable, "-m", "dynpoint.exports", path, to], check=True)
        self.assertEqual(chain[-1].read_bytes(), chain[0].read_bytes())
        wrong = subprocess.run([sys.executable, "-m", "dynpoint.exports", chain[0], self.room / "x.csv"],
                               capture_output=True, text=True, check=False)
        self.assertEqual((wrong.returncode, "wanted .dpr, .h5" in wrong.stderr), (1, True))

    def test_nan_of_a_broken_device_and_a_file_that_is_cut(self):
        need("h5py")
        take = self.takes[0]
        records = take.records.copy()
        records["velocity"][3] = np.array([0x7FF8000000001234, 0xFFF0000000000000, 1], np.uint64).view(np.float64)
        broken = exports.Take(take.header, records, b"")
        exports.write(broken, self.room / "nan.h5")
        exports.read(self.room / "nan.h5").save(self.room / "nan.dpr")
        self.assertEqual(exports.load(self.room / "nan.dpr").records["velocity"].tobytes(), records["velocity"].tobytes())
        (self.room / "cut.dpr").write_bytes(self.paths[0].read_bytes()[:-100])
        with self.assertWarnsRegex(UserWarning, "what is before it is read"):
            self.assertEqual(len(exports.load(self.room / "cut.dpr").records), TICKS - 1)

    def test_what_cannot_be_written_leaves_the_old_file(self):
        need("h5py", "mcap", "pyarrow")
        take, room = self.takes[0], self.room / "old"
        room.mkdir()
        broken = take._replace(pieces=None)
        for write, name, error in ((exports.to_hdf5, "a.h5", TypeError), (exports.to_mcap, "a.mcap", TypeError)):
            write(take, room / name)
            before = (room / name).read_bytes()
            self.assertRaises(error, write, broken, room / name)
            self.assertEqual((room / name).read_bytes(), before)
        self.assertRaises(AttributeError, exports.to_lerobot, [broken], room / "set")
        take.save(room / "a.dpr")
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, limits[1]))  # a full disk
        try:
            self.assertRaises(OSError, take.save, room / "a.dpr")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        self.assertEqual((room / "a.dpr").read_bytes(), self.paths[0].read_bytes())
        self.assertEqual(sorted(path.name for path in room.iterdir()), ["a.dpr", "a.h5", "a.mcap"])
        (room / "link.dpr").symlink_to("a.dpr")
        self.takes[1].save(room / "link.dpr")
        self.assertEqual(((room / "link.dpr").is_symlink(), (room / "a.dpr").read_bytes()),
                         (True, self.paths[1].read_bytes()))

    def test_the_contract_is_written(self):
        contract = Path(__file__).resolve().parents[2] / "docs/exports.md"
        text = contract.read_text(encoding="utf-8")
        for name, what in exports.FIELDS.items():
            self.assertIn(f"| `{name}` | " + " | ".join(what) + " |", text)


if __name__ == "__main__":
    main()
