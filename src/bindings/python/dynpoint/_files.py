# SPDX-License-Identifier: BSD-3-Clause
"""Files that are whole when they have their name, the program, and locks."""
from __future__ import annotations

import os
import re
import secrets
import shutil
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import IO, Any, Iterator

from ._mesh import PathLike

# The program `dynpoint`, as the package has it.
PROGRAM = Path(__file__).with_name("program.exe" if os.name == "nt" else "program")
# What is behind a name until the file is whole.
PART = re.compile(r"\.[0-9]+-[0-9a-f]{8}\.part$")


@contextmanager
def whole(path: PathLike) -> Iterator[Path]:
    """What to write to in place of `path`, a file or a folder: it gets that name at the block's end. After an exception
    nothing is left of it, and what had the name before still has it. A link, a pipe and a device are written to as they
    are."""
    path = Path(path)
    if path.is_symlink() or (path.exists() and not path.is_file()):
        yield path
        return
    part = path.with_name(f"{path.name}.{os.getpid()}-{secrets.token_hex(4)}.part")
    try:
        yield part
        if path.exists():
            shutil.copymode(path, part)
        os.replace(part, path)
    except BaseException:
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        else:
            part.unlink(missing_ok=True)
        raise


def lock_file(file: IO[Any]) -> None:
    """Until it is closed, or the program has ended, nobody else has this lock: file_lock of drivers/platform/file.h. Else
    BlockingIOError. A file system without locks lets everybody in, and so does Windows here."""
    if os.name == "nt":
        return
    locks: Any = import_module("fcntl")
    try:
        locks.flock(file, locks.LOCK_EX | locks.LOCK_NB)
    except BlockingIOError:
        raise
    except OSError:
        pass
