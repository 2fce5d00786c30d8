"""The Python module for pip: CMake builds it, its own `install` puts it where the wheel wants it.

LUMBRICAL_BUILD names a build folder that has it already; else one is made in build/python.
"""
import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def run(self):
        if self.inplace or getattr(self, "editable_mode", False):
            # pip would say that it has installed what can't be imported: the module is built, not in the tree.
            sys.exit("lumbrical can't be installed as editable (-e), since its module is C++: use pip install .")
        destination = pathlib.Path(self.build_lib).resolve()
        built = os.environ.get("LUMBRICAL_BUILD")
        build = pathlib.Path(built) if built else SOURCE / "build" / "python"
        if not built:
            self.cmake("-S", SOURCE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DLUMBRICAL_PYTHON=ON",
                       "-DLUMBRICAL_PROGRAM=OFF", "-DLUMBRICAL_TESTS=OFF", "-DLUMBRICAL_BENCH=OFF",
                       "-DLUMBRICAL_MODBUS=OFF", "-DLUMBRICAL_OPENVDB=OFF", "-DLUMBRICAL_PYTHON_FOLDER=.",
                       f"-DPYTHON_EXECUTABLE={sys.executable}")
            self.cmake("--build", build, "--target", "lumbrical_python")
        self.cmake("--install", build, "--component", "python", "--prefix", destination)
        for package in destination.rglob("lumbrical/__init__.py"):
            if package.parent != destination / "lumbrical":  # of a build for the system's folders
                package.parent.rename(destination / "lumbrical")
        for other in destination.iterdir():  # what belongs to a package of Debian's only
            if other.name != "lumbrical":
                shutil.rmtree(other)

    @staticmethod
    def cmake(*arguments):
        subprocess.run(["cmake", *map(str, arguments)], check=True)


setup(ext_modules=[Extension("lumbrical._lumbrical", sources=[])], cmdclass={"build_ext": CMakeBuild})
