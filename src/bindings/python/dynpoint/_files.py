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


def _lock(file: IO[bytes]) -> bool:
    """False: somebody else has it. A file system without locks gives it to everybody."""
    if os.name == "nt":
        return _lock_windows(file)
    locks: Any = import_module("fcntl")
    try:
        locks.flock(file, locks.LOCK_EX | locks.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True


def _lock_windows(file: IO[bytes]) -> bool:
    """By LockFileEx: msvcrt.locking does not tell a lock of somebody else's from a file system without locks."""
    ctypes: Any = import_module("ctypes")
    handle = ctypes.c_void_p(import_module("msvcrt").get_osfhandle(file.fileno()))
    exclusive, at_once, violation, pending = 2, 1, 33, 997
    where = (ctypes.c_uint32 * 8)(0, 0, 0, 0, _LOCKED_BYTE)  # an OVERLAPPED with this offset
    kernel = ctypes.WinDLL("kernel32", use_last_error=True)
    had = kernel.LockFileEx(handle, exclusive | at_once, 0, 1, 0, ctypes.byref(where))
    return bool(had) or ctypes.get_last_error() not in (violation, pending)


@contextmanager
def locked(path: PathLike) -> Iterator[None]:
    """Until the block's end, or the program's, nobody else has this file's lock: file_lock of drivers/platform/file.h.
    Else BlockingIOError. What has no length, as a pipe, is not locked. A file system without locks lets everybody in."""
    if not Path(path).is_file():
        yield
        return
    with _open_to_lock(path) as file:
        if not _lock(file):
            raise BlockingIOError(errno.EAGAIN, "another call works on this list", os.fspath(path))
        yield
