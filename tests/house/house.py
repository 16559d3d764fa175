"""Functions that the checks of this folder share: the files of a tree, and lists that may only shrink."""

import os
import re
import subprocess

# Folders that hold no sources, for a tree without git.
SKIPPED = re.compile(r"build.*|out|\.git|__pycache__")


def tracked_files(root):
    """Returns the paths, relative to `root`, of the files that git tracks; without git, of all files."""
    git = subprocess.run(["git", "-c", f"safe.directory={os.path.abspath(root)}", "-C", root, "ls-files", "-z"],
                         check=False, capture_output=True, text=True)
    paths = git.stdout.split("\0")[:-1] if git.returncode == 0 else []
    if not paths:
        for folder, folders, files in os.walk(root):
            folders[:] = [name for name in folders if not SKIPPED.fullmatch(name)]
            paths += [os.path.relpath(os.path.join(folder, name), root) for name in files]
    return sorted(path for path in paths if os.path.isfile(os.path.join(root, path)))


def has_ctags():
    """Returns whether `ctags` is Universal Ctags."""
    try:
        version = subprocess.run(["ctags", "--version"], check=False, capture_output=True, text=True).stdout
    except FileNotFoundError:
        version = ""
    return "Universal Ctags" in version


def read(root, path):
    """Returns the text of a file; bytes that are not UTF-8 are replaced."""
    with open(os.path.join(root, path), encoding="utf-8", errors="replace") as file:
        return file.read()


# A string, a character or a comment of C++ or JavaScript.
TOKEN = re.compile(r'R"([^()\s\\]{0,16})\((?s:.*?)\)\1"'
                   r'|"(?:\\.|[^"\\\n])*"'
                   r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])*'"
                   r"|//[^\n]*|/\*(?s:.*?)\*/")
# Suite and name of a test of C++.
TEST_NAME = re.compile(r"\b(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")
