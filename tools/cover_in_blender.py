# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender, before the addon is imported: counts which of its lines run.

`./dev coverage` says where coverage.py is and where the counts go, which
tools/pytest_in_blender.py writes in the end.
"""

import os
import sys

sys.path.append(os.environ["SPECULA_COVERAGE_PACKAGES"])
import coverage

coverage.Coverage(
    data_file=os.environ["COVERAGE_FILE"], data_suffix=True, source=[os.environ["SPECULA_ADDON"]]
).start()
