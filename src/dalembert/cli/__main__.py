"""``python -m dalembert.cli``."""

import sys

from dalembert.cli.app import main

sys.exit(main())
