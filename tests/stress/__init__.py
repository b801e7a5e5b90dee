"""Stress test: thousands of random models, extreme numbers and hostile files, judged independently.

``python -m tests.stress --help`` describes the command. The test suite keeps a small sample
(``tests/test_stress.py``).
"""

import sys
from pathlib import Path

if (folder := str(Path(__file__).parents[1])) not in sys.path:  # where the random models are
    sys.path.insert(0, folder)
