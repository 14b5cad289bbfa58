# SPDX-License-Identifier: BSD-3-Clause
"""Files that are whole when they have their name, the program, and locks."""
from __future__ import annotations

import errno
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


# What is locked on Windows, a byte far behind what is read: that of file_lock in drivers/platform/windows/windows.c.
_LOCKED_BYTE = 0x7FFFFFFE


def _open_to_lock(path: PathLike) -> IO[bytes]:
    try:
        return open(path, "r+b")  # NFS locks what is open to be written
    except OSError:
        return open(path, "rb")


def _lock(file: IO[bytes]) -> None:
    """BlockingIOError or PermissionError where somebody else has it, another OSError where there are no locks."""
    locks: Any
    if os.name == "nt":
        locks = import_module("msvcrt")
        os.lseek(file.fileno(), _LOCKED_BYTE, os.SEEK_SET)
        locks.locking(file.fileno(), locks.LK_NBLCK, 1)
    else:
        locks = import_module("fcntl")
        locks.flock(file, locks.LOCK_EX | locks.LOCK_NB)


@contextmanager
def locked(path: PathLike) -> Iterator[None]:
    """Until the block's end, or the program's, nobody else has this file's lock: file_lock of drivers/platform/file.h.
    Else BlockingIOError. What has no length, as a pipe, is not locked. A file system without locks lets everybody in."""
    if not Path(path).is_file():
        yield
        return
    with _open_to_lock(path) as file:
        try:
            _lock(file)
        except (BlockingIOError, PermissionError):
            raise BlockingIOError(errno.EAGAIN, "another call works on this list", os.fspath(path)) from None
        except OSError:
            pass
        yield
