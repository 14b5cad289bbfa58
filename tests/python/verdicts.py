# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the package share: unittest's verdicts in the words of tests/lib/verdict.sh, and where things are."""
import os
import subprocess
import sys
import unittest
from pathlib import Path

BUILD = Path(os.environ["DYNPOINT_BUILD"])
PROGRAM = BUILD / "dynpoint"


class Verdicts(unittest.TextTestResult):
    def addSuccess(self, test):
        super().addSuccess(test)
        print("ok", test._testMethodName.removeprefix("test_").replace("_", " "), flush=True)

    def addFailure(self, test, error):
        super().addFailure(test, error)
        print(self.failures[-1][1], file=sys.stderr)
        print("FAIL", test._testMethodName.removeprefix("test_").replace("_", " "), self.failures[-1][1].strip().splitlines()[-1], flush=True)

    def addError(self, test, error):
        super().addError(test, error)
        print(self.errors[-1][1], file=sys.stderr)
        print("FAIL", test._testMethodName.removeprefix("test_").replace("_", " "), self.errors[-1][1].strip().splitlines()[-1], flush=True)

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        print(f"skip {test._testMethodName.removeprefix('test_').replace('_', ' ')}: {reason}", flush=True)


def main():
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    with open(os.devnull, "w") as nowhere:
        result = unittest.TextTestRunner(stream=nowhere, resultclass=Verdicts).run(suite)
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun - bad - len(result.skipped)} passed, {bad} failed, {len(result.skipped)} skipped")
    sys.exit(bad > 0)


def program(*arguments):
    """The C program's output."""
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True).stdout
