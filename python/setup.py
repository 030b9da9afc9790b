"""Builds the library with make and packs it, so that the wheel fits any Python 3."""

import os
import shutil
import subprocess
import sysconfig
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent.parent
# The library needs memcpy, memmove, memset and memcmp of the C library, no newer than this.
GLIBC = "manylinux_2_17"
FILES = {
    "LICENSE": "LICENSE",
    "packaging/NOTICES.txt": "NOTICES.txt",
    "models/posewise.posewise": "posewise.posewise",
    "models/research.posewise": "research.posewise",
}


class BuildPy(build_py):
    """Adds the shared library, without a model built in, and the models."""

    def run(self):
        super().run()
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "python"
        make = ["make", "--silent", "--directory", ROOT, "lib", "notices", "MODEL=none"]
        subprocess.run([*make, f"TARGET_DIR={target}"], check=True)
        package = Path(self.build_lib) / "posewise"
        (library,) = (target / "dist" / "lib").glob("libposewise.so.*")
        shutil.copyfile(library, package / "libposewise.so")
        for source, name in FILES.items():
            shutil.copyfile(ROOT / source, package / name)


class BdistWheel(bdist_wheel):
    """Any Python 3, this kind of machine."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        return "py3", "none", platform.replace("linux", GLIBC, 1)


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


setup(distclass=BinaryDistribution, cmdclass={"build_py": BuildPy, "bdist_wheel": BdistWheel})
