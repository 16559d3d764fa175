"""Builds the wheel, for pip (PEP 517) and for the script `wheel`: CMake builds the module, which is
zipped together with the package. Needs the build dependencies of winnow, pybind11 and numpy, but no
network. Optimizes for this machine (WINNOW_ISAS=native), or with `wheel --portable` for all.

WINNOW_PYTHON_BUILD names a folder to build in and keep; otherwise that is a temporary one.
WINNOW_PYTHON_OPTIONS are further options for CMake.
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PACKAGES = "cmake ninja-build g++ libeigen3-dev libxsimd-dev libtbb-dev pybind11-dev"


def version():
    text = (HERE / "pyproject.toml").read_text()
    return re.search(r'^version = "(.*)"$', text, re.MULTILINE).group(1)


def tag():
    python = "cp%d%d" % sys.version_info[:2]
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return "%s-%s-%s" % (python, python, platform)


def run(*command):
    """Runs a build; prints the progress of ninja or make, and the output only if it fails."""
    output = []
    tenth = 0
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        for line in process.stdout:
            output.append(line)
            step = re.match(r"\[ *(\d+)(?:/(\d+)|%)\]", line)
            done = 10 * int(step[1]) // int(step[2] or 100) if step else 0
            if done > tenth:
                tenth = done
                print("winnow: %d %%" % (10 * done), file=sys.stderr, flush=True)
    if process.returncode != 0:
        sys.stderr.write("".join(output))
        raise SystemExit(
            "winnow: failed: %s\nOn Debian it needs: apt-get install %s"
            % (shlex.join(command), PACKAGES)
        )


def build_module(folder, isas):
    """Builds the module and returns the folder of the package that contains it."""
    if shutil.which("cmake") is None:
        raise SystemExit("winnow: there is no cmake\nOn Debian: apt-get install " + PACKAGES)
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    options = shlex.split(os.environ.get("WINNOW_PYTHON_OPTIONS", ""))
    print("winnow: building the module, which takes some minutes", file=sys.stderr, flush=True)
    run(
        "cmake", "-S", str(ROOT), "-B", str(folder), *generator, "-DCMAKE_BUILD_TYPE=Release",
        "-DWINNOW_PYTHON=ON", "-DWINNOW_TESTS=OFF", "-DWINNOW_BENCH=OFF", "-DWINNOW_INSTALL=OFF",
        "-DPython_EXECUTABLE=" + sys.executable, *isas, *options,
    )  # fmt: skip
    run(
        "cmake", "--build", str(folder), "--target", "winnow_python",
        "--parallel", str(os.cpu_count() or 1),
    )  # fmt: skip
    return folder / "pipeline" / "python" / "winnow"


def metadata():
    return "Metadata-Version: 2.1\nName: winnow\nVersion: %s\nLicense: MIT\n%s" % (
        version(),
        "Requires-Python: >=3.9\nRequires-Dist: numpy\n",
    )


def write_wheel(package, directory):
    info = "winnow-%s.dist-info" % version()
    name = "winnow-%s-%s.whl" % (version(), tag())
    files = {
        "winnow/" + path.name: path.read_bytes()
        for path in sorted(package.iterdir())
        if path.suffix in (".py", ".pyi", ".so") or path.name == "py.typed"
    }
    files[info + "/METADATA"] = metadata().encode()
    files[info + "/WHEEL"] = (
        "Wheel-Version: 1.0\nGenerator: winnow\nRoot-Is-Purelib: false\nTag: %s\n" % tag()
    ).encode()
    files[info + "/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    record = ""
    for path, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += "%s,sha256=%s,%d\n" % (path, digest, len(content))
    files[info + "/RECORD"] = (record + info + "/RECORD,,\n").encode()
    os.makedirs(directory, exist_ok=True)
    with zipfile.ZipFile(os.path.join(directory, name), "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, (2020, 1, 1, 0, 0, 0))
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return name


def make_wheel(directory, isas):
    kept = os.environ.get("WINNOW_PYTHON_BUILD")
    if kept:
        return write_wheel(build_module(pathlib.Path(kept).resolve(), isas), directory)
    with tempfile.TemporaryDirectory() as folder:
        return write_wheel(build_module(pathlib.Path(folder), isas), directory)


NATIVE = ["-DWINNOW_ISAS=native"]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return make_wheel(wheel_directory, NATIVE)


if __name__ == "__main__":
    *portable, directory = sys.argv[1:]
    print(os.path.join(directory, make_wheel(directory, [] if portable else NATIVE)))
