"""Puts what tests share on the path of imports."""

import os
import sys

import hypothesis

sys.path.insert(0, os.path.dirname(__file__))

# A machine that is busy is not a failure, and failures come again.
hypothesis.settings.register_profile("winnow", deadline=None, derandomize=True, database=None)
hypothesis.settings.load_profile("winnow")
