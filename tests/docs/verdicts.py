# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the pages print: a line a check, and last what tests/run.sh adds up."""


class Verdicts:
    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def __call__(self, right, text):
        self.passed += bool(right)
        self.failed += not right
        print(f"  {'ok  ' if right else 'FAIL'} {text}")

    def skip(self, text):
        self.skipped += 1
        print(f"  skip {text}")

    def finish(self):
        """The last line; the status of the program."""
        print(f"{self.passed} passed, {self.failed} failed, {self.skipped} skipped")
        return self.failed > 0
