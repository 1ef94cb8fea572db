# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of `./dev`: Python 3.11, standard library only."""
