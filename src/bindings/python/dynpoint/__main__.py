# SPDX-License-Identifier: BSD-3-Clause
"""The program `dynpoint`, as the package has it."""
from __future__ import annotations

import os
import sys
from pathlib import Path

from . import _view


def main() -> None:
    if _view.serves(sys.argv[1:]) and not _view.has_libwebsockets():
        sys.exit(_view.command(sys.argv[2:]))
    program = Path(__file__).with_name("program")
    try:
        os.execv(program, ["dynpoint", *sys.argv[1:]])
    except PermissionError:  # installed without the right to execute
        os.chmod(program, 0o755)
        os.execv(program, ["dynpoint", *sys.argv[1:]])


if __name__ == "__main__":
    main()
