# SPDX-License-Identifier: BSD-3-Clause
"""The program `dynpoint`, as the package has it."""
from __future__ import annotations

import os
import subprocess
import sys
from typing import List

from . import _view
from ._files import PROGRAM


def _become(words: List[str]) -> None:
    if os.name != "nt":
        os.execv(PROGRAM, ["dynpoint", *words])
    program = subprocess.Popen([PROGRAM, *words])  # who called would not wait for what this becomes
    while True:
        try:
            sys.exit(program.wait())
        except KeyboardInterrupt:  # it is the program's, which ends its loop then
            continue


def main() -> None:
    if _view.serves(sys.argv[1:]) and not _view.has_libwebsockets():
        sys.exit(_view.command(sys.argv[2:]))
    try:
        _become(sys.argv[1:])
    except PermissionError:  # installed without the right to execute
        os.chmod(PROGRAM, 0o755)
        _become(sys.argv[1:])


if __name__ == "__main__":
    main()
