"""A studio without pictures that compute, for tests of drawings and texts.

Such a picture takes one to two seconds of the processor after each change, and a process that is
started again where the next change outdates it.
"""

from __future__ import annotations

import sys

from dalembert.cli import main
from dalembert.studio import picture_feed

if __name__ == "__main__":  # not in the processes that make pictures
    picture_feed.KINDS = ("still",)  # type: ignore[assignment]
    sys.exit(main())
