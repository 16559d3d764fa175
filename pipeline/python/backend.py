"""Builds the wheel, for pip (PEP 517) and for the script `wheel`: CMake builds the module, which is
zipped together with the package. Needs the build dependencies of winnow, pybind11 and numpy, but no
network. Optimizes for this machine (WINNOW_ISAS=native), or with `wheel --portable` for all.

WINNOW_PYTHON_BUILD names a folder to build in and keep; otherwise that is a temporary one.
WINNOW_PYTHON_OPTIONS are further options for CMake.
"""

import ast
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
PACKAGES = "cmake ninja-build g++ libeigen3-dev libxsimd-dev libtbb-dev pybind11-dev python3-dev"

# A project that prints the Debian packages which the build lacks.
CHECK = """
cmake_minimum_required(VERSION 3.25)
project(check CXX)
macro(need package found)
  if(NOT ${found})
    message(NOTICE "lacks ${package}")
  endif()
endmacro()
find_package(Eigen3 3.4 QUIET NO_MODULE)
need(libeigen3-dev Eigen3_FOUND)
find_path(xsimd xsimd/xsimd.hpp)
need(libxsimd-dev xsimd)
find_package(TBB 2021 QUIET CONFIG)
need(libtbb-dev TBB_FOUND)
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
need(python3-dev Python_Development.Module_FOUND)
find_package(pybind11 2.10 QUIET CONFIG)
need(pybind11-dev pybind11_FOUND)
"""


def project():
    """Returns the fields of pyproject.toml that are strings or lists of strings."""
    text = (HERE / "pyproject.toml").read_text()
    fields = re.findall(r'^([\w-]+) = ("[^"]*"|\["[^]]*\]|\[\n[^]]*\])', text, re.MULTILINE)
    fields += re.findall(r'^([\w-]+) = \[?\{ \w+ = ("[^"]*") \}', text, re.MULTILINE)
    return {name: ast.literal_eval(value) for name, value in fields}


def version():
    return project()["version"]


def repository():
    """Returns the address of the repository, if it is on the web, else nothing."""
    command = ["git", "-C", str(ROOT), "remote", "get-url", "origin"]
    try:
        found = subprocess.run(command, check=False, capture_output=True, text=True).stdout.strip()
    except FileNotFoundError:
        found = ""
    address = os.environ.get("WINNOW_REPOSITORY") or re.sub(r"^git@([^:]*):", r"https://\1/", found)
    return re.sub(r"\.git$", "", address) if address.startswith("https:") else ""


def report(text):
    """Prints to the terminal, because pip hides the output of builds; without one, to stderr."""
    try:
        with open("/dev/tty", "w") as terminal:
            terminal.write("\r" + text + "\n")
    except OSError:
        print(text, file=sys.stderr, flush=True)


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
                report("winnow: %d %%" % (10 * done))
    if process.returncode != 0:
        sys.stderr.write("".join(output))
        raise SystemExit("winnow: failed: " + shlex.join(command))


def missing():
    """Returns the Debian packages that the build lacks, and an explanation if that is unknown."""
    compilers = [os.environ.get("CXX", "c++").split()[0], "g++", "clang++"]
    tools = {"cmake": ["cmake"], "ninja-build": ["ninja", "make"], "g++": compilers}
    lacks = [name for name, any_of in tools.items() if not any(map(shutil.which, any_of))]
    if lacks:
        return lacks, "Other packages may be missing too; a build needs: " + PACKAGES
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "CMakeLists.txt").write_text(CHECK)
        options = shlex.split(os.environ.get("WINNOW_PYTHON_OPTIONS", ""))
        command = ["cmake", "-S", folder, "-B", folder + "/build", *generator(), *options,
                   "-DPython_EXECUTABLE=" + sys.executable]  # fmt: skip
        checked = subprocess.run(command, check=False, capture_output=True, text=True)
    output = checked.stdout + checked.stderr
    return re.findall(r"^lacks (.*)", output, re.MULTILINE), output if checked.returncode else ""


def expect_packages():
    """Ends the build at once, with the names of missing packages, if it cannot succeed."""
    lacks, why = missing()
    if lacks:
        why = "winnow: missing packages. On Debian: apt-get install %s\n%s" % (" ".join(lacks), why)
    if why:
        raise SystemExit(why.rstrip())


def generator():
    return ["-G", "Ninja"] if shutil.which("ninja") else []


def build_module(folder, isas):
    """Builds the module and returns the folder of the package that contains it."""
    expect_packages()
    options = shlex.split(os.environ.get("WINNOW_PYTHON_OPTIONS", ""))
    report("winnow: building the module, which takes some minutes")
    run(
        "cmake", "-S", str(ROOT), "-B", str(folder), *generator(), "-DCMAKE_BUILD_TYPE=Release",
        "-DWINNOW_PYTHON=ON", "-DWINNOW_TESTS=OFF", "-DWINNOW_BENCH=OFF", "-DWINNOW_INSTALL=OFF",
        "-DPython_EXECUTABLE=" + sys.executable, *isas, *options,
    )  # fmt: skip
    run(
        "cmake", "--build", str(folder), "--target", "winnow_python",
        "--parallel", str(os.cpu_count() or 1),
    )  # fmt: skip
    return folder / "pipeline" / "python" / "winnow"


def metadata():
    fields = project()
    rows = [
        ("Metadata-Version", "2.1"),
        ("Name", fields["name"]),
        ("Version", fields["version"]),
        ("Summary", fields["description"]),
        ("Author", fields["authors"]),
        ("License", fields["license"]),
        ("Keywords", ",".join(fields["keywords"])),
        ("Requires-Python", fields["requires-python"]),
        ("Description-Content-Type", "text/markdown"),
        *(("Classifier", name) for name in fields["classifiers"]),
        *(("Requires-Dist", name) for name in fields["dependencies"]),
        *(("Project-URL", "Repository, " + address) for address in [repository()] if address),
    ]
    text = "".join("%s: %s\n" % row for row in rows)
    return text + "\n" + (HERE / fields["readme"]).read_text(encoding="utf-8")


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


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    expect_packages()
    info = "winnow-%s.dist-info" % version()
    folder = pathlib.Path(metadata_directory, info)
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text(metadata(), encoding="utf-8")
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return make_wheel(wheel_directory, NATIVE)


if __name__ == "__main__":
    *portable, directory = sys.argv[1:]
    print(os.path.join(directory, make_wheel(directory, [] if portable else NATIVE)))
