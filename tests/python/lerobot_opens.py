# SPDX-License-Identifier: BSD-3-Clause
"""LeRobot itself opens what to_lerobot wrote, each episode and each column, and hands it to learning: lerobot_opens.py SET
WANTED.npz. The second is what NumPy reads of the recordings, "EPISODE/FIELD" each. Needs lerobot and PyTorch, and
nothing of dynpoint. A line for each check, as verdicts.py."""

import sys
from pathlib import Path

import numpy as np
import torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset

STATE, ACTION = ("pose", "velocity", "spin", "asked"), ("proxy", "sent")


def main(root, path):
    failed = False

    def verdict(good, what):
        nonlocal failed
        failed = failed or not good
        print("ok" if good else "FAIL", f"LeRobot: {what}", flush=True)

    wanted = np.load(path)
    episodes = sorted({int(name.split("/")[0]) for name in wanted.files})
    fields = sorted({name.split("/")[1] for name in wanted.files})
    counts = [len(wanted[f"{i}/dt"]) for i in episodes]
    whole = LeRobotDataset("local/dynpoint", root=Path(root))
    verdict(
        (whole.num_episodes, len(whole), whole.meta.tasks.index.tolist()) == (len(episodes), sum(counts), ["press"]),
        f"it opens the set: {whole.num_episodes} episodes, {len(whole)} frames at {whole.fps} Hz",
    )
    # Frames at both ends of each episode, and between.
    ends = np.cumsum([0, *counts])
    rows = [(i, at) for i in episodes for at in sorted({0, 1, counts[i] // 2, counts[i] - 1})]
    strange = set()
    for i, at in rows:
        frame = whole[int(ends[i] + at)]
        if (int(frame["episode_index"]), int(frame["frame_index"]), frame["task"]) != (i, at, "press"):
            strange.add("the frame's place")
        if abs(float(frame["timestamp"]) - at / whole.fps) > 1e-6:
            strange.add("timestamp")
        for name in fields:
            number = wanted[f"{i}/{name}"][at]
            made = number.astype(np.float32) if number.dtype == np.float64 else number  # as LeRobot hands it on
            if not np.array_equal(frame[f"dynpoint.{name}"].numpy(), made, equal_nan=True):
                strange.add(name)
        for name, parts in (("observation.state", STATE), ("action", ACTION)):
            made = np.concatenate([wanted[f"{i}/{part}"][at] for part in parts]).astype(np.float32)
            if not np.array_equal(frame[name].numpy(), made):
                strange.add(name)
    verdict(not strange, f"{len(rows)} frames have the recordings' numbers in all {len(fields)} columns"
            f"{', but for ' + str(sorted(strange)) if strange else ''}")
    # What came a tick before, by time: LeRobot compares the times of all frames with its rate.
    step = 1 / whole.fps
    pairs = LeRobotDataset("local/dynpoint", root=Path(root), episodes=[1], delta_timestamps={"action": [-step, 0.0]})
    action = np.concatenate([wanted[f"1/{part}"] for part in ACTION], axis=1).astype(np.float32)
    verdict(
        np.array_equal(pairs[7]["action"].numpy(), action[6:8]), "an action and the one before it, of the second episode"
    )
    batch = next(iter(torch.utils.data.DataLoader(whole, batch_size=16)))
    state = np.concatenate([wanted[f"0/{part}"] for part in STATE], axis=1).astype(np.float32)
    verdict(np.array_equal(batch["observation.state"].numpy(), state[:16]), "a batch of PyTorch's loader")
    both = np.concatenate([wanted[f"{i}/asked"] for i in episodes])
    stats = whole.meta.stats["dynpoint.asked"]
    verdict(
        np.allclose(stats["mean"], both.mean(0)) and np.allclose(stats["max"], both.max(0)), "its statistics are the recordings'"
    )
    return failed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
