"""Entry point of ``python -m dalembert``."""

import sys

from dalembert.cli import main

sys.exit(main())
