# SPDX-License-Identifier: BSD-3-Clause
"""Each shared library of BUILD loads alone, in a process of its own, whatever the folder, and finds those that it needs
beside itself: alone.py BUILD. Last line: N passed, M failed, K skipped."""
import glob
import os
import subprocess
import sys

build = os.path.abspath(sys.argv[1])
libraries = sorted(glob.glob(os.path.join(build, "libdynpoint*.so.1")))
environment = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}
passed = failed = 0
for library in libraries:
    run = subprocess.run([sys.executable, "-c", "import ctypes, sys; ctypes.CDLL(sys.argv[1])", library], cwd="/",
                         env=environment, stderr=subprocess.PIPE, text=True)
    passed += run.returncode == 0
    failed += run.returncode != 0
    print("  %s %s loads alone" % ("ok  " if run.returncode == 0 else "FAIL", os.path.basename(library)))
    if run.returncode:
        print("    " + run.stderr.strip().splitlines()[-1])
if len(libraries) < 4:
    print("  FAIL there are %d libraries" % len(libraries))
    failed += 1
print("%d passed, %d failed, 0 skipped" % (passed, failed))
sys.exit(failed != 0)
