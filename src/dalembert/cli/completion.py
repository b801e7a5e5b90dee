"""``dalembert completion``: completion scripts for shells."""

from __future__ import annotations

from typing import Literal

from dalembert.cli.console import DONE, AsJson, print_json


def completion(shell: Literal["bash", "zsh", "fish"], /, *, as_json: AsJson = False) -> int:
    """Print the completion script of a shell.

    bash: dalembert completion bash > ~/.local/share/bash-completion/completions/dalembert

    zsh: dalembert completion zsh > a folder of $fpath, as _dalembert

    fish: dalembert completion fish > ~/.config/fish/completions/dalembert.fish

    Parameters
    ----------
    shell
        bash, zsh or fish.
    """
    from dalembert.cli.app import make_app

    script = make_app().generate_completion(shell=shell)
    if as_json:
        print_json({"ok": True, "shell": shell, "script": script})
    else:
        print(script)
    return DONE
