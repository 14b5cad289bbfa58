# SPDX-License-Identifier: BSD-3-Clause
"""Packs what the Makefile builds: the extension and the program (python.mk). DYNPOINT_PARTS names a folder that has them
already; else make is called, in the tree that this lies in, or in `tree` of a source package. DYNPOINT_TREE names another."""
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import setuptools

# As pyproject.toml has it: older ones lack bdist_wheel, or do not know its license.
if int(setuptools.__version__.split(".")[0]) < 77:
    sys.exit(f"dynpoint: its package needs setuptools 77 or newer, and {sys.executable} has {setuptools.__version__}: "
             f"{sys.executable} -m pip install --upgrade setuptools")

from setuptools import Extension, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext

HERE = Path(__file__).resolve().parent
ROOT = Path(os.environ.get("DYNPOINT_TREE", HERE / "tree" if (HERE / "tree").is_dir() else HERE.parents[2]))
VERSION = re.search(r'DPT_VERSION_STRING "(.*)"', (ROOT / "include/dynpoint/base.h").read_text(encoding="utf-8"))[1]


class Build(build_ext):
    """The extension and the program, where the package has them."""

    def build_extension(self, ext):
        parts = os.environ.get("DYNPOINT_PARTS")
        if not parts:
            subprocess.run(["make", f"-j{os.cpu_count() or 1}", "-s", "python-parts", f"PYTHON={sys.executable}",
                            f"VIEW_PAGE={'made' if (ROOT / 'build/view/page.html').exists() else 'no'}"],
                           cwd=ROOT, check=True)
            parts = ROOT / "build/python/parts"
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        for made in Path(parts).glob("_dynpoint.*"):  # for Windows it is a .pyd, also where this is another system
            shutil.copy2(made, target.with_name(made.name) if made.suffix == ".pyd" else target)
        for folder in {target.parent, HERE / "dynpoint"} if self.inplace or self.editable_mode else {target.parent}:
            for program in Path(parts).glob("dynpoint*"):
                shutil.copy2(program, folder / f"program{program.suffix}")
            for part in (*Path(parts).glob("libdynpoint_*.so"), *Path(parts).glob("page.*")):
                shutil.copy2(part, folder / part.name)


class Wheel(bdist_wheel):
    """The platform of its system, unless DYNPOINT_PLATFORM names another, as for a machine that it is built for."""

    def get_tag(self):
        tag = super().get_tag()
        return (*tag[:2], os.environ.get("DYNPOINT_PLATFORM", tag[2]))


# A build of Python without its lock has no limited API (python_error.h).
LIMITED = not sysconfig.get_config_var("Py_GIL_DISABLED")
setup(version=VERSION, ext_modules=[Extension("dynpoint._dynpoint", [], py_limited_api=LIMITED)],
      cmdclass={"build_ext": Build, "bdist_wheel": Wheel}, 
      options={"bdist_wheel": {"py_limited_api": "cp311"}} if LIMITED else {})
