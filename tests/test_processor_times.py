"""The list of processor times replaces no file of tests."""

from pathlib import Path

import pytest
from processor_times import ProcessorTimes


def test_a_file_of_tests_is_not_taken_for_the_list(tmp_path: Path) -> None:
    """``pytest --processor-times tests/test_x.py``: the file is the value of the option."""
    path = tmp_path / "test_x.py"
    path.write_text("kept")
    with pytest.raises(pytest.UsageError, match=r"write --processor-times=FILE"):
        ProcessorTimes(path)
    assert path.read_text() == "kept"
