"""Model files: TOML and JSON with one schema."""

from dalembert.io.json_schema import json_schema
from dalembert.io.model_file import ModelFile, load, load_model_file

__all__ = ["ModelFile", "json_schema", "load", "load_model_file"]
