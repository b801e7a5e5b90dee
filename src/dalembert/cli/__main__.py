"""``python -m dalembert.cli``."""

import sys

from dalembert.cli import main

sys.exit(main())
