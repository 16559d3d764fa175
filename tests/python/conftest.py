"""Adds the shared modules of the tests to the import path."""

import os
import sys

import hypothesis

sys.path.insert(0, os.path.dirname(__file__))

# A busy machine must not cause failures, and failures must be repeatable.
hypothesis.settings.register_profile("winnow", deadline=None, derandomize=True, database=None)
hypothesis.settings.load_profile("winnow")
