"""Builds the library with make and packs it, so that the wheel fits any Python 3.

The machine is this one, or the one that _PYTHON_HOST_PLATFORM names, as linux-aarch64.
"""

import os
import platform
import shutil
import subprocess
import sysconfig
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent.parent
# The library names no C library and asks for no version of its functions, which are memcpy and the
# like. So it fits every glibc and every musl; these are the oldest that pip has names for.
LIBCS = ("manylinux_2_17", "musllinux_1_1")
FILES = {
    "LICENSE": "LICENSE",
    "packaging/NOTICES.txt": "NOTICES.txt",
    "models/posewise.posewise": "posewise.posewise",
    "models/research.posewise": "research.posewise",
}


def machine():
    """The machine that the wheel is for, as x86_64."""
    return sysconfig.get_platform().rsplit("-", 1)[1]


class BuildPy(build_py):
    """Adds the shared library, without a model built in, and the models."""

    def run(self):
        super().run()
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "python"
        make = ["make", "--silent", "--directory", ROOT, "lib", "notices", "MODEL=none"]
        make += ["LIBC=none", f"TARGET_DIR={target}"]
        if machine() != platform.machine():
            name = f"{machine()}-unknown-linux-gnu"
            make += [f"TARGET={name}"]
            target /= name
        subprocess.run(make, check=True)
        package = Path(self.build_lib) / "posewise"
        (library,) = (target / "dist" / "lib").glob("libposewise.so.*")
        shutil.copyfile(library, package / "libposewise.so")
        for source, name in FILES.items():
            shutil.copyfile(ROOT / source, package / name)


class BdistWheel(bdist_wheel):
    """Any Python 3, one kind of machine."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", ".".join(f"{libc}_{machine()}" for libc in LIBCS)


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


setup(distclass=BinaryDistribution, cmdclass={"build_py": BuildPy, "bdist_wheel": BdistWheel})
