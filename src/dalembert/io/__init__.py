"""Model files: TOML and JSON with one schema."""

from dalembert.io.documents import json_schema
from dalembert.io.model_file import ModelFile, load_model, load_model_file

load = load_model

__all__ = ["ModelFile", "json_schema", "load", "load_model", "load_model_file"]
